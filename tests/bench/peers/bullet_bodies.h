// A scene as Bullet's rigid bodies with constraints, the way its users build ragdolls: btHingeConstraint and
// btPoint2PointConstraint in the solver of sequential impulses, with its defaults. Bodies that a fixed joint
// holds together are one body. A hinge's dry friction is a motor of speed 0 with a largest impulse. Linked
// bodies do not collide.
#pragma once

#include <memory>

#include "tests/bench/peers/stepper.h"

namespace visum::bench {

// Free boxes, or a jointed scene without springs and damping, which these constraints do not have.
bool is_bullet_scene(const world::WorldModel& model);

// Throws std::runtime_error where a body's axes are not its principal axes of inertia.
std::unique_ptr<Stepper> make_bullet_bodies(const world::WorldModel& model);

}  // namespace visum::bench
