// Scenes that several tests of the suite share.
#pragma once

#include "tests/dynamics/contract/rows.h"

namespace visum::dynamics::testing {

// An arm of three hinges and a slider on the world, above the ground, with boxes, a ball and a cylinder
// falling on it. It has every kind of joint that both engines have, contacts that come and go, and drives in
// use.
world::WorldModel busy_model(const world::EngineSetting& engine);
void set_busy_drives(Lab& lab);
// Puts a mesh of two triangles, 2 m wide and across x, in place of each box.
void make_boxes_sheets(world::WorldModel& model);

}  // namespace visum::dynamics::testing
