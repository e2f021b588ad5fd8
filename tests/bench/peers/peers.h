// The other engines, each in files of its own that are built only if its package is found (peers.txt). They
// get the same WorldModel. In models without shapes joints are hinges whose frame in the child is the
// identity, as serial_models.h and loop_models.h build them. MuJoCo and Bullet also take scenes with contacts
// (is_boxes_only, is_jointed_scene). MuJoCo closes loops by its soft constraint `connect`.
#pragma once

#include <vector>

#include "tests/bench/peers/stepper.h"

namespace visum::bench {

void add_bare_ode(std::vector<StepperKind>& kinds);  // ode-bare: dWorldStep without our seam
void add_mujoco(std::vector<StepperKind>& kinds);    // mujoco (Euler), mujoco-rk4
void add_bullet(std::vector<StepperKind>& kinds);    // bullet: btMultiBody, or rigid bodies
void add_dart(std::vector<StepperKind>& kinds);
void add_simbody(std::vector<StepperKind>& kinds);  // semi-explicit Euler
void add_kdl(std::vector<StepperKind>& kinds);      // its forward dynamics, semi-implicit Euler around it

}  // namespace visum::bench
