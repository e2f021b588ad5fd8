// The other engines, each in a file of its own that is built only if its package is found (peers.txt). They
// get the same WorldModel: joints are hinges whose frame in the child is the identity, as serial_models.h and
// loop_models.h build them. MuJoCo also closes loops, by its soft constraint `connect`.
#pragma once

#include <vector>

#include "tests/bench/peers/stepper.h"

namespace visum::bench {

void add_bare_ode(std::vector<StepperKind>& kinds);  // ode-bare: dWorldStep without our seam
void add_mujoco(std::vector<StepperKind>& kinds);    // mujoco (Euler), mujoco-rk4
void add_bullet(std::vector<StepperKind>& kinds);    // bullet: btMultiBody, or rigid boxes
void add_dart(std::vector<StepperKind>& kinds);
void add_simbody(std::vector<StepperKind>& kinds);  // semi-explicit Euler
void add_kdl(std::vector<StepperKind>& kinds);      // its forward dynamics, semi-implicit Euler around it

}  // namespace visum::bench
