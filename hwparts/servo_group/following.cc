// How a group of servos follows the trajectory of its blackboard.
#include <algorithm>
#include <vector>

#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"
#include "hwparts/servo_group/servo_group.h"

namespace visum::servo_group {

namespace bit = drive::state_bit;

std::optional<std::string> ServoGroup::write_blackboard(std::size_t index, std::uint64_t offset,
                                                        std::span<const std::byte> data) {
  if (description_.blackboards[index].name != trajectory_.board().name)
    return Part::write_blackboard(index, offset, data);
  const auto cannot_move = [](const Axis& axis) {
    const auto& state = axis.drive.state();
    return drive::has(state, bit::kError | bit::kHalted) || !drive::has(state, bit::kHomeOk) || state.homing;
  };
  const bool stops = offset == 0 && data.empty();
  if (!stops && (!state_.enabled || std::ranges::any_of(axes_, cannot_move)))
    return "the drives may not move now: the part state says why";
  std::vector<Trajectory::Ability> abilities;
  for (const auto& axis : axes_) {
    const auto& state = axis.drive.state();
    const double n = static_cast<double>(axis.run.count);
    abilities.insert(
        abilities.end(), axis.run.count,
        {state.setpoint.position / n, state.tuning.maximum_speed / n, state.tuning.maximum_acceleration / n});
  }
  const bool was_running = trajectory_.is_running();
  if (auto reason = trajectory_.write(offset, data, abilities)) return reason;
  if (was_running && trajectory_.is_empty()) end_trajectory();
  return std::nullopt;
}

double ServoGroup::trajectory_target(const Axis& axis) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < axis.run.count; ++i) sum += trajectory_.target(axis.run.first + i);
  return sum;
}

bool ServoGroup::follows_trajectory(const Axis& axis) const {
  const auto& state = axis.drive.state();
  const bool is_commanded_anew = state.commanded != state.hold_target;
  return state.by_bus && !is_commanded_anew && state.motion.kind == drive::MotionKind::kStep &&
         state.motion.target == axis.step;
}

void ServoGroup::end_trajectory() {
  for (auto& axis : axes_)
    if (follows_trajectory(axis)) axis.drive.hold();
  trajectory_.stop();
}

void ServoGroup::follow_trajectory() {
  if (!trajectory_.is_running()) return;
  const bool goes_on = !trajectory_.has_begun() || std::ranges::all_of(axes_, [this](const Axis& axis) {
    return follows_trajectory(axis);
  });
  if (!goes_on || !state_.enabled || any(bit::kError | bit::kHalted)) return end_trajectory();
  if (trajectory_.begins_step()) {
    for (auto& axis : axes_) {
      axis.step = trajectory_target(axis);
      axis.drive.step_by_bus(axis.step, trajectory_.step_s());
    }
  }
  trajectory_.tick();
}

}  // namespace visum::servo_group
