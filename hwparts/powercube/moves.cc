#include "hwparts/powercube/moves.h"

#include <algorithm>
#include <cmath>

#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"
#include "hwparts/powercube/parameter_rules.h"

namespace visum::powercube {
namespace {

namespace bit = drive::state_bit;
using drive::goes_to_a_place;
using drive::Motion;
using drive::MotionKind;

struct Mode {
  std::uint8_t simple;
  std::optional<std::uint8_t> extended;
  MotionKind kind;
  bool increments;
};
constexpr Mode kModes[] = {
    {0x04, 0x0E, MotionKind::kRamp, false},     {0x06, 0x10, MotionKind::kStep, false},
    {0x07, 0x11, MotionKind::kVelocity, false}, {0x08, 0x12, MotionKind::kCurrent, false},
    {0x09, 0x13, MotionKind::kRamp, true},      {0x0B, 0x15, MotionKind::kStep, true},
    {0x0C, 0x16, MotionKind::kVelocity, true},  {0x0D, 0x17, MotionKind::kCurrent, true},
    {0x18, {}, MotionKind::kCosine, false},
};

const Mode* find_mode(std::uint8_t byte) {
  const auto found = std::ranges::find_if(
      kModes, [byte](const Mode& mode) { return mode.simple == byte || mode.extended == byte; });
  return found == std::end(kModes) ? nullptr : found;
}

// A 16-bit time in ms stands behind the target.
bool has_time(MotionKind kind) {
  return kind == MotionKind::kStep || kind == MotionKind::kCosine;
}

// A current in digits comes as 16 bits (KTH, the Bosch header) or as 32 (m5api).
bool length_fits(const Mode& mode, std::size_t size) {
  if (has_time(mode.kind)) return size == 8;
  if (mode.kind == MotionKind::kCurrent && mode.increments && size == 4) return true;
  return size == 6;
}

double raw_value(const Mode& mode, const Message& message) {
  if (!mode.increments) return value_at<float>(message, 2);
  return message.size == 4 ? value_at<std::int16_t>(message, 2) : value_at<std::int32_t>(message, 2);
}

double target_of(const ModuleView& view, const Mode& mode, double raw) {
  if (!mode.increments) return raw;
  if (mode.kind != MotionKind::kCurrent) return from_increments(view, raw);
  return std::clamp(raw, -kCurrentDigits, kCurrentDigits) / kCurrentDigits * view.data.motor.current_limit;
}

// Treats a target outside of the soft limits as the settings say. False: refused.
bool judge_target(const ModuleView& view, double& target) {
  if (!view.data.limits.limited) return true;
  const double inside = std::clamp(target, view.drive.tuning.soft_minimum, view.drive.tuning.soft_maximum);
  if (static_cast<float>(inside) == static_cast<float>(target))
    target = inside;  // the client sent the limit itself, which it had read as a 32-bit float
  const bool beyond = inside != target;
  if (beyond && view.settings.beyond_limits == BeyondLimits::kRefuse) return false;
  // Far enough inside that the end of a ramp does not trip.
  if (beyond && view.settings.beyond_limits == BeyondLimits::kClamp)
    target = inside + (inside < target ? -view.data.limits.tolerance : view.data.limits.tolerance);
  return true;
}

// `wanted`, cut to the nominal current unless the configuration allows the full current.
double allowed_current(const ModuleEdit& edit, double wanted) {
  const bool full = (edit.module.config & config_bit::kAllowFullCurrent) != 0;
  const double most = full ? edit.drive.state().tuning.maximum_current : edit.data.motor.nominal_current;
  if (std::abs(wanted) > most) edit.drive.warn_of_current_limit();
  return std::clamp(wanted, -most, most);
}

// Starts a step, or queues it behind the running one. The settings decide about a third one.
MoveResult begin_step(const ModuleEdit& edit, double target, double duration_s) {
  const auto& running = edit.drive.state().motion;
  const bool busy = running.kind == MotionKind::kStep && running.in_progress && running.remaining_s > 0.0;
  if (!busy) {
    edit.drive.step_by_bus(target, duration_s);
    return MoveResult::kDone;
  }
  if (running.queued && edit.settings.third_step == ThirdStep::kRefuse) return MoveResult::kRefused;
  if (running.queued && edit.settings.third_step == ThirdStep::kAdvance) edit.drive.start_queued_step();
  edit.drive.queue_step(target, duration_s);
  return MoveResult::kDone;
}

MoveResult carry_out(const ModuleEdit& edit, const Motion& motion) {
  if (goes_to_a_place(motion.kind)) edit.module.target_position = motion.target;
  if (motion.kind == MotionKind::kCosine) {
    edit.drive.move_by_bus(drive::start_cosine(motion.target, motion.duration_s, motion.acceleration));
    return MoveResult::kDone;
  }
  if (motion.kind == MotionKind::kStep) return begin_step(edit, motion.target, motion.duration_s);
  edit.drive.move_by_bus(motion);
  return MoveResult::kDone;
}

}  // namespace

std::optional<Move> read_move(const ModuleView& view, const Message& message) {
  if (message.size < 2) return std::nullopt;
  const auto* mode = find_mode(message.data[1]);
  if (!mode || !length_fits(*mode, message.size)) return std::nullopt;
  Move move{mode->kind, mode->increments, message.data[1] == mode->extended, 0.0, 0.0};
  move.target = target_of(view, *mode, raw_value(*mode, message));
  if (has_time(mode->kind)) move.duration_s = value_at<std::uint16_t>(message, 6) * 1e-3;
  return move;
}

bool accepts_motion(const ModuleView& view) {
  const auto& drive = view.drive;
  if (!view.enabled) return false;
  const bool homed = drive::has(drive, bit::kHomeOk);
  if ((view.module.config & config_bit::kM3Compatible) && !homed) return false;
  return !drive::has(drive, bit::kError | bit::kHalted) && drive.loop_closed && !drive.homing;
}

MoveResult start(const ModuleEdit& edit, const Move& move, bool deferred) {
  if (!std::isfinite(move.target) || !accepts_motion(edit)) return MoveResult::kRefused;
  Motion motion;
  motion.kind = move.kind;
  motion.target = move.target;
  motion.duration_s = move.duration_s;
  motion.speed = edit.module.target_speed;
  motion.acceleration = edit.module.target_acceleration;
  if (goes_to_a_place(move.kind) && !judge_target(edit, motion.target)) return MoveResult::kRefused;
  if (move.kind == MotionKind::kCurrent) motion.target = allowed_current(edit, move.target);
  if (!deferred) return carry_out(edit, motion);
  edit.module.deferred = true;
  edit.module.deferred_motion = motion;
  return MoveResult::kDone;
}

void start_deferred(const ModuleEdit& edit) {
  if (!edit.module.deferred) return;
  edit.module.deferred = false;
  if (accepts_motion(edit)) carry_out(edit, edit.module.deferred_motion);
}

}  // namespace visum::powercube
