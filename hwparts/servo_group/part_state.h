// The sensor output `Part State` of a group of servos: the first of these, from the bottom up, that holds.
#pragma once

namespace visum::servo_group {

enum class PartState {
  kReady = 0,  // stands and takes commands (after a Reset: as soon as a desired value is written anew)
  kMoving = 1,
  kDisabled = 2,        // Execution Enable is 0
  kNotHomed = 3,        // some drive has no HOME_OK: desired values are not followed
  kHalted = 4,          // by Halt; Reset
  kFault = 5,           // some drive has ERROR, all are stopped; Module State says which and why; Reset
  kControllerLost = 6,  // stopped, since whoever held the lease is gone; Reset
  kHoming = 7,          // ranks between kNotHomed and kHalted
};

}  // namespace visum::servo_group
