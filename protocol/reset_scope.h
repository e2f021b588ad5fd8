// The scopes of a reset: how much goes back to the beginning.
#pragma once

namespace visum::protocol {

// The numbers are those of visum.proto and recording.proto.
enum class ResetScope {
  kWorld = 0,    // time and state; bodies that came stay
  kTime = 1,     // time alone: it begins at 0 again, and everything else goes on as it is
  kState = 2,    // state alone: bodies, joints and parts are as in the beginning, and time goes on
  kSpawned = 3,  // what came since the scene was loaded goes, and what went is back
  kAll = 4       // time, state and what was spawned: the scene as it was loaded
};

}  // namespace visum::protocol
