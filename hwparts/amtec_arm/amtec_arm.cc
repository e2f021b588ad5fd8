#include "hwparts/amtec_arm/amtec_arm.h"

#include "hwparts/bus_group/bus_group.h"
#include "hwparts/servo_group/servo_group.h"

namespace visum::amtec_arm {
namespace {

using servo_group::Channel;
using servo_group::DriveList;

constexpr std::size_t kAngles = 7;
constexpr std::size_t kFingers = 2;
constexpr servo_group::PortNames kFinger{"Desired Finger Position", "Maximum Finger Speed",
                                         "Actual Finger Position", "Actual Finger Speed"};

void check_drives(const hwparts::PartContext& context, const DriveList& list) {
  bool right = list.drives.size() == kAngles + 1;
  for (std::size_t i = 0; right && i < list.drives.size(); ++i) {
    const auto& drive = list.drives[i];
    const bool gripper = i == kAngles;
    right = drive.data.linear == gripper && !drive.data.speed_controlled &&
            drive.joints.size() == (gripper ? kFingers : 1);
  }
  if (right) return;
  context.config.get("drives").fail(
      "an amtec_arm has 7 rotary drives of one joint each and then one linear drive of two joints, all "
      "commanded by position; "
      "for other robots there is the kind servo_group");
}

// The arm's blocks of channels: angles 1..7, then the fingers 1..2 of the one gripper drive.
std::vector<std::vector<Channel>> blocks(const DriveList& list) {
  std::vector<Channel> angles, fingers;
  for (std::size_t d = 0; d < kAngles; ++d) {
    angles.push_back({d, list.drives[d].joints[0], servo_group::kAngle, static_cast<int>(d) + 1});
  }
  for (std::size_t i = 0; i < kFingers; ++i) {
    fingers.push_back({kAngles, list.drives[kAngles].joints[i], kFinger, static_cast<int>(i) + 1});
  }
  return {angles, fingers};
}

}  // namespace

std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context) {
  const auto options = servo_group::read_options(context.config);
  const auto drives = servo_group::load_drives(context);
  check_drives(context, drives);
  auto layout =
      servo_group::make_layout(blocks(drives), drives, context, {options.homed, options.execution_enable});
  return std::make_unique<servo_group::ServoGroup>(context, "amtec_arm", drives, options, std::move(layout));
}

std::unique_ptr<hwparts::Part> make_real(const hwparts::PartContext& context, powercube::BusConnection& line,
                                         const hwparts::RealOptions& options) {
  return bus_group::make({"amtec_arm", check_drives, blocks}, context, line, options);
}

}  // namespace visum::amtec_arm
