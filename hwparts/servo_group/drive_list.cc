#include "hwparts/servo_group/drive_list.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <system_error>

#include "hwparts/servo_group/tuning.h"
#include "protocol/config/read_file.h"

namespace visum::servo_group {
namespace {

using config::Node;
using hwparts::JointInfo;
using hwparts::PartContext;

std::optional<std::size_t> index_of(const PartContext& context, const std::string& joint) {
  for (std::size_t i = 0; i < context.joints.size(); ++i) {
    if (context.joints[i].name == joint) return i;
  }
  return std::nullopt;
}

// The joints of one entry; empty if they all belong to another part.
std::vector<std::size_t> bind_joints(const Node& names, const PartContext& context) {
  if (names.size() == 0 || names.size() > drive::kMaxJointsPerDrive) {
    names.fail("must name 1 to " + std::to_string(drive::kMaxJointsPerDrive) + " joints");
  }
  std::vector<std::size_t> joints;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (const auto joint = index_of(context, names.at(i).text())) joints.push_back(*joint);
  }
  if (!joints.empty() && joints.size() != names.size()) {
    names.fail("the part '" + context.name + "' has some of these joints, but not all");
  }
  return joints;
}

void check_alike(const Node& names, const PartContext& context, const std::vector<std::size_t>& joints) {
  const JointInfo& first = context.joints[joints.front()];
  for (std::size_t joint : joints) {
    const JointInfo& other = context.joints[joint];
    if (other.prismatic != first.prismatic) names.fail("one drive cannot move a hinge and a slider alike");
    if (std::abs(other.initial_position - first.initial_position) > 1e-9) {
      names.fail("one drive moves '" + first.name + "' and '" + other.name +
                 "' alike, so they must start at the same position");
    }
  }
}

void check_start(const Node& entry, const DriveEntry& drive) {
  const auto& limits = drive.data.limits;
  const double start = drive.initial_position;
  if (!limits.limited || (start >= limits.hard_minimum && start <= limits.hard_maximum)) return;
  entry.find("limits").value_or(entry).fail("the drive starts at " + std::to_string(start) +
                                            ", outside of its hard limits");
}

// The loop of a drive runs between ticks, so it cannot run more often than they come.
void check_period(const Node& entry, double period, double tick_s) {
  const double ticks = period / tick_s;
  if (period == 0.0 || (ticks > 0.5 && std::abs(ticks - std::round(ticks)) < 1e-6 * ticks)) return;
  entry.get("loop")
      .get("period_s")
      .fail("must be a whole number of ticks, of " + std::to_string(tick_s) +
            " s each; without it the loop runs in each tick");
}

void check_gains(const Node& entry, const drive::DriveData& data, double tick_s) {
  const auto tuning = drive::initial_tuning(data);
  for (const auto& field : tuning_fields()) {
    const auto range = field.range(data, tick_s);
    const double value = tuning.*field.member;
    if (value >= range.minimum && value <= range.maximum) continue;
    entry.fail(std::string(field.name) + " is " + std::to_string(value) +
               ", but for a loop that runs every " + std::to_string(data.loop_period(tick_s)) +
               " s it must be between " + std::to_string(range.minimum) + " and " +
               std::to_string(range.maximum));
  }
}

// The sums of the joints' bounds. All of them have stops, or the drive has none.
drive::JointBounds bounds_of(const PartContext& context, const std::vector<std::size_t>& joints,
                             std::size_t number) {
  drive::JointBounds bounds{0.0, 0.0, 0.0, static_cast<int>(number)};
  bool limited = true;
  for (const std::size_t index : joints) {
    const JointInfo& joint = context.joints[index];
    limited = limited && joint.lower <= joint.upper;
    bounds.lower += joint.lower;
    bounds.upper += joint.upper;
    bounds.maximum_speed += joint.maximum_speed;
  }
  if (!limited) bounds.lower = 1.0, bounds.upper = -1.0;
  return bounds;
}

// The lightest link counts where joints share a gear.
drive::Load load_of(const PartContext& context, const std::vector<std::size_t>& joints) {
  drive::Load load{true, context.joints[joints.front()].inertia};
  for (const std::size_t joint : joints) {
    load.moves_by_mean_speed &= context.joints[joint].moves_by_mean_speed;
    load.inertia = std::min(load.inertia, context.joints[joint].inertia);
  }
  load.inertia /= static_cast<double>(joints.size());
  return load;
}

DriveEntry read_entry(const Node& entry, const PartContext& context, std::vector<std::size_t> joints,
                      std::size_t number) {
  check_alike(entry.get("joints"), context, joints);
  DriveEntry drive;
  drive.data = drive::read_drive_data(entry, context.joints[joints.front()].prismatic,
                                      bounds_of(context, joints, number));
  for (std::size_t joint : joints) drive.initial_position += context.joints[joint].initial_position;
  drive.load = load_of(context, joints);
  drive.joints = std::move(joints);
  check_start(entry, drive);
  check_period(entry, drive.data.loop.period, context.tick_s);
  check_gains(entry, drive.data, context.tick_s);
  return drive;
}

void check_complete(const Node& drives, const PartContext& context, const DriveList& list) {
  std::vector<int> times(context.joints.size(), 0);
  std::vector<int> modules;
  for (const auto& drive : list.drives) {
    for (std::size_t joint : drive.joints) ++times[joint];
    if (std::ranges::find(modules, drive.data.module) != modules.end()) {
      drives.fail("two drives have the module id " + std::to_string(drive.data.module));
    }
    modules.push_back(drive.data.module);
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] == 0) drives.fail("there is no drive for the joint '" + context.joints[i].name + "'");
    if (times[i] > 1) drives.fail("the joint '" + context.joints[i].name + "' has more than one drive");
  }
}

}  // namespace

DriveList load_drives(const PartContext& context) {
  const Node key = context.config.get("drives");
  if (context.joints.empty()) context.config.fail("the part has no joints to drive");
  const std::filesystem::path path = key.folder() / key.text();
  std::error_code error;
  if (!config::is_file(path) && !std::filesystem::is_directory(path, error))
    key.fail("'" + path.string() + "': no such file");
  const Node file = config::load_file(path);
  file.allow_only({"source", "drives"});
  DriveList list;
  list.source = file.get("source").text();
  const Node drives = file.get("drives");
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Node entry = drives.at(i);
    auto joints = bind_joints(entry.get("joints"), context);
    if (!joints.empty()) list.drives.push_back(read_entry(entry, context, std::move(joints), i + 1));
  }
  if (list.drives.size() > kMaxDrives)
    drives.fail("more than " + std::to_string(kMaxDrives) + " drives in one part");
  check_complete(drives, context, list);
  return list;
}

}  // namespace visum::servo_group
