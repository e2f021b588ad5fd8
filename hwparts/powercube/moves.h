// SETMOVE: what a module is told to do, as the drive's motions. Ramp, step, velocity and current, each with a
// float or in increments, each answered with 64 or with position and state. Mode bytes: from the m5api
// header.
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
  double duration_s = 0.0;  // steps
};

// Nothing for a mode that there is not, or a wrong length.
std::optional<Move> read_move(const ModuleView& view, const Message& message);

// Why a motion is refused now.
enum class MoveResult { kDone, kRefused };
MoveResult start(const ModuleEdit& edit, const Move& move, bool deferred);
// What SYNC_MOTION kept back.
void start_deferred(const ModuleEdit& edit);
// True while motion commands are taken: no fault, not halted, powered, Execution Enable 1, not on the way
// home.
bool accepts_motion(const ModuleView& view);

}  // namespace visum::powercube
