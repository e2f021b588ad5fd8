#include "hwparts/servo_group/servo_group.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hwparts/drive/motor.h"
#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"
#include "hwparts/sensors/random.h"
#include "hwparts/servo_group/identity.h"

namespace visum::servo_group {
namespace {

namespace bit = drive::state_bit;

constexpr std::size_t kTrajectoryBoard = 1;  // in the description
constexpr std::uint8_t kStopBit = 1, kTrajectoryBit = 2;

std::vector<drive::DriveData> data_of(const DriveList& list) {
  std::vector<drive::DriveData> data;
  for (const auto& entry : list.drives) data.push_back(entry.data);
  return data;
}

std::vector<double> positions_of(const DriveList& list) {
  std::vector<double> positions;
  for (const auto& entry : list.drives) positions.push_back(entry.initial_position);
  return positions;
}

// Notes a counter's new value; true where it differs from the last one.
bool changes(double& seen, double now) {
  const bool changed = seen != now;
  seen = now;
  return changed;
}

PortNames port_names(const drive::DriveData& data) {
  if (data.speed_controlled) return data.linear ? kPositionBySpeed : kAngleBySpeed;
  return data.linear ? kPosition : kAngle;
}

}  // namespace

ServoGroup::ServoGroup(const hwparts::PartContext& context, const std::string& kind, const DriveList& drives,
                       const PartOptions& options, PortLayout layout)
    : layout_(std::move(layout)),
      tick_s_(context.tick_s),
      modules_(context.config, data_of(drives), positions_of(drives), options.homed, context.tick_s),
      trajectory_(layout_, tick_s_),
      seed_(context.seed),
      identity_(identity_text(kind, drives)) {
  for (const auto& entry : drives.drives) {
    axes_.push_back({drive::Drive(entry.data, entry.initial_position, options.homed, tick_s_, entry.load),
                     {joints_.size(), entry.joints.size()},
                     context.joints[entry.joints.front()].name,
                     0.0});
    joints_.insert(joints_.end(), entry.joints.begin(), entry.joints.end());
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) modules_.bind(i, axes_[i].drive);
  initial_.enabled = options.execution_enable;
  initial_.supply_voltage = axes_.front().drive.state().tuning.supply_voltage;
  initial_.on_controller_lost = options.on_controller_lost;
  state_ = initial_;
  modules_.enable(state_.enabled);
  description_ = {context.name,           kind,         layout_.controller_inputs,
                  layout_.sensor_outputs, parameters(), {identity_board(identity_)}};
  const auto is_sent_to_places = [](const Axis& axis) { return !axis.drive.data().speed_controlled; };
  if (std::ranges::all_of(axes_, is_sent_to_places)) description_.blackboards.push_back(trajectory_.board());
}

std::optional<std::string> ServoGroup::refuse(std::span<const double> inputs) const {
  if (auto reason = refuse_counters(layout_, inputs)) return reason;
  for (const auto& axis : axes_) {
    const double tolerance = axis.drive.data().increment();
    if (auto reason = refuse_unequal(layout_, axis.run, tolerance, inputs)) return reason;
  }
  return std::nullopt;
}

void ServoGroup::act(std::span<const double> inputs, std::span<const hwparts::JointSample> samples,
                     std::span<hwparts::JointDrive> drives) {
  latch(inputs);
  apply_counters(inputs);
  interlock();
  modules_.tick();
  follow_trajectory();
  const bool fault = any(bit::kError);
  for (auto& axis : axes_) {
    const bool enabled = state_.enabled && (!fault || axis.drive.state().by_bus);
    const auto trips = axis.drive.trips();
    axis.drive.act({target(axis, inputs), maximum_speed(layout_, axis.run, inputs), enabled},
                   samples.subspan(axis.run.first, axis.run.count),
                   drives.subspan(axis.run.first, axis.run.count));
    if (axis.drive.trips() != trips) axis.tripped = ++trips_;
  }
  acted_ = true;
}

// Also called between ticks, as soon as inputs arrive: a telegram that comes next is then later than these
// inputs and overrides them.
void ServoGroup::latch(std::span<const double> inputs) {
  state_.enabled = inputs[layout_.enable] >= 0.5;
  modules_.enable(state_.enabled);
  for (auto& axis : axes_) axis.drive.latch(target(axis, inputs));
}

void ServoGroup::apply_counters(std::span<const double> inputs) {
  if (changes(state_.reset, inputs[layout_.reset])) {
    interlock();
    modules_.drop_deferred();
    for (auto& axis : axes_) axis.drive.reset();
  }
  const bool may_move = state_.enabled && !any(bit::kError);
  if (changes(state_.home, inputs[layout_.home]) && may_move) {
    modules_.drop_deferred();
    for (auto& axis : axes_) axis.drive.home();
  }
  if (changes(state_.halt, inputs[layout_.halt])) {
    modules_.drop_deferred();
    for (auto& axis : axes_) axis.drive.halt();
  }
}

// While one drive is stopped, all drives stand, and desired values written meanwhile do not count. A drive
// that was homing for the ports when another one failed does not go on by itself after the Reset.
void ServoGroup::interlock() {
  if (any(bit::kError | bit::kHalted)) {
    for (auto& axis : axes_) axis.drive.hold();
  }
  if (!any(bit::kError)) return;
  for (auto& axis : axes_) axis.drive.cancel_homing_of_ports();
}

double ServoGroup::target(const Axis& axis, std::span<const double> inputs) const {
  return desired_value(layout_, axis.run, inputs);
}

void ServoGroup::publish(std::span<const hwparts::JointSample> samples, std::span<double> outputs) {
  if (acted_) ++state_.changed;
  acted_ = false;
  for (std::size_t number = 0; number < axes_.size(); ++number) {
    auto& axis = axes_[number];
    axis.drive.publish(samples.subspan(axis.run.first, axis.run.count), encoder_noise(number));
    const auto& state = axis.drive.state();
    const double n = static_cast<double>(axis.run.count);
    for (std::size_t i = axis.run.first; i < axis.run.first + axis.run.count; ++i) {
      const auto& channel = layout_.channels[i];
      outputs[channel.actual] = state.measured_position / n;
      outputs[channel.speed] = state.measured_speed / n;
      outputs[channel.current] = state.current;
      outputs[channel.state] = modules_.state_word(number);
    }
  }
  outputs[layout_.part_state] = static_cast<double>(part_state());
  outputs[layout_.changed] = static_cast<double>(state_.changed);
}

double ServoGroup::encoder_noise(std::size_t axis) const {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15u;
  const double deviation = axes_[axis].drive.broken().encoder_deviation;
  if (deviation == 0.0) return 0.0;
  return deviation *
         sensors::Random(seed_ + kOdd * (state_.changed * axes_.size() + axis), description_.name).normal();
}

std::optional<std::string> ServoGroup::refuse_fault(const hwparts::Fault& fault) const {
  if (auto reason = Part::refuse_fault(fault)) return reason;
  if (hwparts::fault_info(fault.kind).target != hwparts::FaultTarget::kDrive) return std::nullopt;
  const std::string number = std::to_string(fault.drive() + 1);
  if (fault.drive() >= axes_.size())
    return "there is no drive " + number + "; '" + description_.name + "' has " +
           std::to_string(axes_.size()) + " drives";
  if (auto reason = servo_group::refuse(fault, axes_[fault.drive()].drive.data()))
    return "drive " + number + " " + *reason;
  return std::nullopt;
}

void ServoGroup::set_faults(std::span<const hwparts::ActiveFault> faults) {
  const auto before = std::exchange(faults_, group_faults(faults));
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].drive.set_broken(broken_of(faults, i));
  modules_.set_faults(faults_.bus, seed_);
  const bool same_supply =
      before.emergency_stop == faults_.emergency_stop && before.most_supply_v == faults_.most_supply_v;
  if (!same_supply) supply_drives();
}

void ServoGroup::following_errors(std::span<double> errors) const {
  for (const auto& axis : axes_) {
    const auto& state = axis.drive.state();
    const double commanded =
        (state.setpoint.position - state.zero_offset) / static_cast<double>(axis.run.count);
    for (std::size_t i = 0; i < axis.run.count; ++i)
      errors[axis.run.first + i] = commanded - state.joint_position[i];
  }
}

bool ServoGroup::any(std::uint32_t bits) const {
  return std::ranges::any_of(axes_, [&](const Axis& axis) { return drive::has(axis.drive.state(), bits); });
}

std::string ServoGroup::trip_text(std::uint64_t since) const {
  std::string text;
  for (const auto& axis : axes_) {
    const auto& state = axis.drive.state();
    if (!drive::has(state, bit::kError) || (since > 0 && axis.tripped <= since)) continue;
    // Restored from a snapshot, the figures of the moment are gone: those of now stand for them.
    drive::Trip trip = axis.drive.trip();
    if ((trip.bits & state.latched) == 0) {
      trip = drive::figures_of(state);
      trip.bits = state.latched;
    }
    trip.bits &= state.latched;  // what a Reset has cleared is over
    trip.rest_s = drive::i2t_rest(axis.drive.data().motor, state.i2t);
    const std::string why = drive::trip_text(axis.drive.data(), trip);
    const bool all_lost =
        trip.bits == bit::kCommError && text.empty() && axes_.size() > 1 &&
        std::ranges::all_of(axes_, [](const Axis& one) {
          return one.drive.trip().bits == bit::kCommError && drive::has(one.drive.state(), bit::kCommError);
        });
    if (all_lost) return "all drives: " + why;
    text += (text.empty() ? "" : "\n") + axis.joint + ": " + why;
  }
  return text;
}

PartState ServoGroup::part_state() const {
  const auto some = [&](auto holds) {
    return std::ranges::any_of(axes_, [&](const Axis& axis) { return holds(axis.drive.state()); });
  };
  if (any(bit::kCommError)) return PartState::kControllerLost;
  if (any(bit::kError)) return PartState::kFault;
  if (any(bit::kHalted)) return PartState::kHalted;
  if (some([](const auto& state) { return state.homing; })) return PartState::kHoming;
  if (some([](const auto& state) { return !drive::has(state, bit::kHomeOk); })) return PartState::kNotHomed;
  if (!state_.enabled) return PartState::kDisabled;
  const bool moving = some([](const auto& state) { return (drive::state_word(state) & bit::kMotion) != 0; });
  return moving ? PartState::kMoving : PartState::kReady;
}

void ServoGroup::controller_lost() {
  if (state_.on_controller_lost == OnControllerLost::kHold) return;
  for (auto& axis : axes_) axis.drive.lose_controller();
}

void ServoGroup::place(std::span<const std::size_t> moved, std::span<const hwparts::JointSample> samples) {
  modules_.drop_deferred();
  for (auto& axis : axes_) {
    const auto is_ours = [&](std::size_t joint) { return joint - axis.run.first < axis.run.count; };
    if (std::ranges::any_of(moved, is_ours))
      axis.drive.place(samples.subspan(axis.run.first, axis.run.count));
  }
}

void ServoGroup::reset() {
  for (auto& axis : axes_) axis.drive.restart();
  modules_.restart();
  state_ = initial_;
  trajectory_.clear();
  modules_.enable(state_.enabled);
  acted_ = false;
}

std::span<const std::byte> ServoGroup::read_blackboard(std::size_t index) const {
  if (index == kTrajectoryBoard) return trajectory_.bytes();
  if (index != 0) return {};
  return std::as_bytes(std::span(identity_));
}

void ServoGroup::save(hwparts::StateWriter& to) const {
  for (const auto& axis : axes_) axis.drive.save(to);
  modules_.save(to);
  to.put(state_.reset), to.put(state_.home), to.put(state_.halt);
  to.put(state_.enabled), to.put(state_.on_controller_lost), to.put(state_.changed);
  to.put(state_.supply_voltage);
  // A part without a trajectory has the bytes, and the hash, that it always had.
  const bool has_trajectory = !trajectory_.is_empty();
  to.put(static_cast<std::uint8_t>((state_.emergency_stop ? kStopBit : 0) |
                                   (has_trajectory ? kTrajectoryBit : 0)));
  if (!has_trajectory) return;
  trajectory_.save(to);
  for (const auto& axis : axes_) to.put(axis.step);
}

void ServoGroup::load(hwparts::StateReader& from) {
  for (auto& axis : axes_) axis.drive.load(from);
  modules_.load(from);
  from.get(state_.reset), from.get(state_.home), from.get(state_.halt);
  from.get(state_.enabled), from.get(state_.on_controller_lost), from.get(state_.changed);
  from.get(state_.supply_voltage);
  std::uint8_t bits = 0;
  from.get(bits);
  state_.emergency_stop = (bits & kStopBit) != 0;
  trajectory_.clear();
  if ((bits & kTrajectoryBit) != 0) {
    trajectory_.load(from);
    for (auto& axis : axes_) from.get(axis.step);
  }
  modules_.enable(state_.enabled);
  acted_ = false;
}

std::vector<std::vector<Channel>> one_block(const DriveList& drives) {
  std::vector<Channel> channels;
  for (std::size_t d = 0; d < drives.drives.size(); ++d) {
    for (std::size_t joint : drives.drives[d].joints) {
      channels.push_back(
          {d, joint, port_names(drives.drives[d].data), static_cast<int>(channels.size()) + 1});
    }
  }
  return {channels};
}

std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context) {
  const auto options = read_options(context.config);
  const auto drives = load_drives(context);
  auto layout = make_layout(one_block(drives), drives, context, {options.homed, options.execution_enable});
  return std::make_unique<ServoGroup>(context, "servo_group", drives, options, std::move(layout));
}

}  // namespace visum::servo_group
