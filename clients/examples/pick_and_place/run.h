// Carries out the plan, phase by phase, and prints a line of text for each.
#pragma once

#include <stdexcept>

#include "clients/examples/pick_and_place/arm.h"
#include "clients/examples/pick_and_place/gripper.h"
#include "clients/examples/pick_and_place/plan.h"

namespace visum::pick_and_place {

// The gripper has closed on nothing, or has lost the box.
class LostBox : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Prints to stdout. Throws LostBox, and what Arm::tick() throws. The arm then stands where its drives
// stopped.
void run(Arm& arm, const ArmModel& model, const Plan& plan, const Job& job, const MotionLimits& limits);

}  // namespace visum::pick_and_place
