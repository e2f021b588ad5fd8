// The sensor output `Part State` of a group of servos. If several hold, the highest number is shown, except
// that kHoming ranks between kNotHomed and kHalted.
#pragma once

namespace visum::servo_group {

enum class PartState {
  kReady = 0,  // stands and takes commands (after a Reset: as soon as a desired value changes)
  kMoving = 1,
  kDisabled = 2,        // Execution Enable is 0
  kNotHomed = 3,        // some drive has no HOME_OK: desired values are not followed
  kHalted = 4,          // by Halt; Reset
  kFault = 5,           // some drive has ERROR, all are stopped; Module State says which and why; Reset
  kControllerLost = 6,  // stopped, since the controller that held the lease is gone; Reset
  kHoming = 7,
};

}  // namespace visum::servo_group
