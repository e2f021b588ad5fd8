// The ports of a group of servos, and the place of each in the vectors of controller inputs (CI) and sensor
// outputs (SO). The order is a contract:
//   CI  for each block of joints: desired 1..n, maximum speed 1..n;
//       then Reset, Home, Halt, Execution Enable
//   SO  actual positions of all blocks, actual speeds of all blocks, Actual Current 1..m, Module State 1..m,
//       Part State, Changed
// A port's number is its channel's: drives that are commanded by position and drives that are commanded by
// speed share one count. A block is a set of joints whose ports have the same names: the arm's angles, the
// gripper's fingers. Plain values and pure functions.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hwparts/part.h"
#include "hwparts/servo_group/drive_list.h"
#include "hwparts/servo_group/part_state.h"
#include "protocol/part_description.h"

namespace visum::servo_group {

struct PortNames {
  const char* desired;
  const char* maximum;
  const char* actual;
  const char* speed;
};
inline constexpr PortNames kAngle{"Desired Angle", "Maximum Speed", "Actual Angle", "Actual Speed"};
inline constexpr PortNames kPosition{"Desired Position", "Maximum Speed", "Actual Position", "Actual Speed"};
inline constexpr PortNames kAngleBySpeed{"Desired Speed", "Maximum Speed", "Actual Angle", "Actual Speed"};
inline constexpr PortNames kPositionBySpeed{"Desired Speed", "Maximum Speed", "Actual Position",
                                            "Actual Speed"};

// One joint of the part, as its ports see it.
struct Channel {
  std::size_t drive;  // index into DriveList::drives
  std::size_t joint;  // index into PartContext::joints
  PortNames names;
  int number;  // "Desired Angle 3"
  // Its places in the vectors.
  std::size_t desired = 0, maximum = 0;
  std::size_t actual = 0, speed = 0, current = 0, state = 0;
};

struct PortLayout {
  std::vector<protocol::Port> controller_inputs;
  std::vector<protocol::Port> sensor_outputs;
  std::vector<Channel> channels;  // drive by drive
  std::size_t reset = 0, home = 0, halt = 0, enable = 0;
  std::size_t part_state = 0, changed = 0;
};

// A drive's run of channels.
struct Run {
  std::size_t first;
  std::size_t count;
};
// The commands to a drive, in the module's coordinate: the sums over its joints. The desired value is a speed
// where the drive is speed-controlled.
double desired_value(const PortLayout& layout, const Run& run, std::span<const double> inputs);
double maximum_speed(const PortLayout& layout, const Run& run, std::span<const double> inputs);
// The reason to refuse these inputs for their counters, or for the values of one drive's joints; nothing if
// they are good. The joints' values may differ by `tolerance` [u].
std::optional<std::string> refuse_counters(const PortLayout& layout, std::span<const double> inputs);
std::optional<std::string> refuse_unequal(const PortLayout& layout, const Run& run, double tolerance,
                                          std::span<const double> inputs);

struct Start {
  bool homed;
  bool execution_enable;
};

// `blocks`: the channels, grouped. Their numbers count from 1 within a block's names.
PortLayout make_layout(const std::vector<std::vector<Channel>>& blocks, const DriveList& drives,
                       const hwparts::PartContext& context, const Start& start);

}  // namespace visum::servo_group
