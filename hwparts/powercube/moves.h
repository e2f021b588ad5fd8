// SETMOVE: turns a module's motion commands into motions of its drive. There are ramp, step, velocity and
// current, each with a float or in increments, and each answered with 64 (hex) or with position and state.
// Their mode bytes are from the m5api header. The cosine loop (FCOSLOOP) is from the ROS package amtec.
#pragma once

#include <optional>

#include "hwparts/powercube/message.h"
#include "hwparts/powercube/module_state.h"

namespace visum::powercube {

struct Move {
  drive::MotionKind kind = drive::MotionKind::kNone;
  bool increments = false;
  bool extended = false;    // answered with position, state, inputs and outputs
  double target = 0.0;      // [u], [u]/s, or A
  double duration_s = 0.0;  // steps, and the period of cosine loops
};

// Nothing for an unknown mode or a wrong length.
std::optional<Move> read_move(const ModuleView& view, const Message& message);

enum class MoveResult { kDone, kRefused };
// Starts a motion, or keeps it back where it is `deferred` (SYNC_MOTION).
MoveResult start(const ModuleEdit& edit, const Move& move, bool deferred);
// Starts the motion that SYNC_MOTION kept back, if there is one.
void start_deferred(const ModuleEdit& edit);
// True while the module takes motion commands: no fault, not halted, powered, Execution Enable 1, not homing;
// and homed, where M3_COMPATIBLE asks for that.
bool accepts_motion(const ModuleView& view);

}  // namespace visum::powercube
