#include "hwparts/servo_group/port_layout.h"

#include <cmath>
#include <utility>

#include "hwparts/drive/encoder.h"
#include "hwparts/drive/supervision.h"
#include "hwparts/servo_group/state_names.h"

namespace visum::servo_group {
namespace {

using protocol::Port;

constexpr double kCounterMaximum = 9007199254740992.0;  // 2^53: beyond it a double cannot count
constexpr double kUnlimited = 1000.0;  // rad, range of the ports of a joint that turns forever
constexpr double kSpeedRange = 10.0;   // range of the speed ports, in maximum speeds of the drive

// Appends a port and returns its index.
std::size_t add(std::vector<Port>& ports, Port port) {
  ports.push_back(std::move(port));
  return ports.size() - 1;
}

std::string numbered(const char* name, int number) {
  return std::string(name) + " " + std::to_string(number);
}

const DriveEntry& entry_of(const DriveList& drives, const Channel& channel) {
  return drives.drives[channel.drive];
}

double share(const DriveEntry& entry) {
  return static_cast<double>(entry.joints.size());
}

// The port is wider than the limits, since commanding beyond a limit must be possible: it trips the limit.
Port position_port(const char* name, const Channel& channel, const DriveEntry& entry, double initial) {
  const auto& limits = entry.data.limits;
  const double width = limits.limited ? limits.hard_maximum - limits.hard_minimum : 0.0;
  const double lowest = limits.limited ? (limits.hard_minimum - width) / share(entry) : -kUnlimited;
  const double highest = limits.limited ? (limits.hard_maximum + width) / share(entry) : kUnlimited;
  return {numbered(name, channel.number), entry.data.linear ? "m" : "rad", lowest, highest, initial, name};
}

double fastest(const DriveEntry& entry) {
  return entry.data.limits.maximum_speed / share(entry);
}

const char* speed_unit(const DriveEntry& entry) {
  return entry.data.linear ? "m/s" : "rad/s";
}

// The port is wider than the drive's maximum speed. Beyond that the drive goes at its maximum.
Port speed_port(const char* name, const Channel& channel, const DriveEntry& entry) {
  const double highest = kSpeedRange * fastest(entry);
  return {numbered(name, channel.number), speed_unit(entry), -highest, highest, 0.0, name};
}

Port desired_port(const Channel& channel, const DriveEntry& entry, double initial) {
  const char* name = channel.names.desired;
  return entry.data.speed_controlled ? speed_port(name, channel, entry)
                                     : position_port(name, channel, entry, initial);
}

void add_inputs(std::vector<Channel>& block, const DriveList& drives, const hwparts::PartContext& context,
                PortLayout& layout) {
  auto& ports = layout.controller_inputs;
  for (auto& channel : block) {
    const double initial = context.joints[channel.joint].initial_position;
    channel.desired = add(ports, desired_port(channel, entry_of(drives, channel), initial));
  }
  for (auto& channel : block) {
    const auto& entry = entry_of(drives, channel);
    channel.maximum = add(ports, {numbered(channel.names.maximum, channel.number), speed_unit(entry), 0.0,
                                  kSpeedRange * fastest(entry), fastest(entry), channel.names.maximum});
  }
}

void add_motion_outputs(std::vector<std::vector<Channel>>& blocks, const DriveList& drives,
                        PortLayout& layout) {
  auto& ports = layout.sensor_outputs;
  for (auto& block : blocks) {
    for (auto& channel : block) {
      const auto& entry = entry_of(drives, channel);
      const double initial = drive::quantised(entry.data, entry.initial_position) / share(entry);
      channel.actual = add(ports, position_port(channel.names.actual, channel, entry, initial));
    }
  }
  for (auto& block : blocks) {
    for (auto& channel : block) {
      channel.speed = add(ports, speed_port(channel.names.speed, channel, entry_of(drives, channel)));
    }
  }
}

void add_module_outputs(const DriveList& drives, const Start& start, PortLayout& layout) {
  auto& ports = layout.sensor_outputs;
  int number = 0;
  for (auto& channel : layout.channels) {
    const double limit = entry_of(drives, channel).data.motor.current_limit;
    channel.current =
        add(ports, {numbered("Actual Current", ++number), "A", -limit, limit, 0.0, "Actual Current"});
  }
  number = 0;
  for (auto& channel : layout.channels) {
    const auto& entry = entry_of(drives, channel);
    const auto word =
        drive::state_word(drive::initial_state(entry.data, entry.initial_position, start.homed));
    channel.state = add(ports, {numbered("Module State", ++number),
                                "",
                                0.0,
                                4294967295.0,
                                static_cast<double>(word),
                                "Module State",
                                {},
                                module_state_bits()});
  }
}

double initial_part_state(const Start& start) {
  if (!start.homed) return static_cast<double>(PartState::kNotHomed);
  return static_cast<double>(start.execution_enable ? PartState::kReady : PartState::kDisabled);
}

Port counter(const char* name) {
  return {name, "", 0.0, kCounterMaximum, 0.0, name};
}

}  // namespace

double desired_value(const PortLayout& layout, const Run& run, std::span<const double> inputs) {
  double sum = 0.0;
  for (std::size_t i = 0; i < run.count; ++i) sum += inputs[layout.channels[run.first + i].desired];
  return sum;
}

double maximum_speed(const PortLayout& layout, const Run& run, std::span<const double> inputs) {
  double sum = 0.0;
  for (std::size_t i = 0; i < run.count; ++i) sum += inputs[layout.channels[run.first + i].maximum];
  return sum;
}

std::optional<std::string> refuse_counters(const PortLayout& layout, std::span<const double> inputs) {
  for (const std::size_t counter : {layout.reset, layout.home, layout.halt, layout.enable}) {
    if (inputs[counter] == std::floor(inputs[counter])) continue;
    return layout.controller_inputs[counter].name + " takes whole numbers only";
  }
  return std::nullopt;
}

std::optional<std::string> refuse_unequal(const PortLayout& layout, const Run& run, double tolerance,
                                          std::span<const double> inputs) {
  const auto& first = layout.channels[run.first];
  for (std::size_t i = run.first + 1; i < run.first + run.count; ++i) {
    const auto& other = layout.channels[i];
    for (const auto& [a, b] :
         {std::pair{first.desired, other.desired}, std::pair{first.maximum, other.maximum}}) {
      if (std::abs(inputs[a] - inputs[b]) <= tolerance) continue;
      return layout.controller_inputs[a].name + " and " + layout.controller_inputs[b].name +
             " must be equal: one drive moves both by the same amount";
    }
  }
  return std::nullopt;
}

PortLayout make_layout(const std::vector<std::vector<Channel>>& wanted, const DriveList& drives,
                       const hwparts::PartContext& context, const Start& start) {
  PortLayout layout;
  auto blocks = wanted;
  for (auto& block : blocks) add_inputs(block, drives, context, layout);
  layout.reset = add(layout.controller_inputs, counter("Reset"));
  layout.home = add(layout.controller_inputs, counter("Home"));
  layout.halt = add(layout.controller_inputs, counter("Halt"));
  layout.enable = add(layout.controller_inputs, {"Execution Enable", "", 0.0, 1.0,
                                                 start.execution_enable ? 1.0 : 0.0, "Execution Enable"});
  add_motion_outputs(blocks, drives, layout);
  for (auto& block : blocks) layout.channels.insert(layout.channels.end(), block.begin(), block.end());
  add_module_outputs(drives, start, layout);
  layout.part_state = add(layout.sensor_outputs, {"Part State", "", 0.0, 7.0, initial_part_state(start),
                                                  "Part State", part_state_names()});
  layout.changed = add(layout.sensor_outputs, counter("Changed"));
  return layout;
}

}  // namespace visum::servo_group
