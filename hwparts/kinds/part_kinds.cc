#include "hwparts/kinds/part_kinds.h"

#include <array>
#include <vector>

#include "hwparts/amtec_arm/amtec_arm.h"
#include "hwparts/bus_group/bus_group.h"
#include "hwparts/ideal_joints/ideal_joints.h"
#include "hwparts/servo_group/servo_group.h"
#include "protocol/config/unknown_name.h"

namespace visum::hwparts {
namespace {

constexpr std::array<PartKind, 3> kPartKinds{{
    {"amtec_arm", "the 7-DOF PowerCube arm with its two-finger gripper", amtec_arm::make,
     amtec_arm::make_real},
    {"servo_group", "any joints of a robot, each with a drive", servo_group::make,
     bus_group::make_servo_group},
    {"ideal_joints", "any joints of a robot, each of which goes where it is told", ideal_joints::make,
     ideal_joints::make_real},
}};

const PartKind& row_of(const std::string& kind, const PartContext& context) {
  for (const auto& row : kPartKinds) {
    if (kind == row.name) return row;
  }
  const auto place = context.config.find("kind").value_or(context.config);
  std::vector<std::string> known;
  for (const auto& row : kPartKinds) known.emplace_back(row.name);
  place.fail(config::unknown_name("kind of part", kind, known));
}

}  // namespace

std::span<const PartKind> part_kinds() {
  return kPartKinds;
}

std::unique_ptr<Part> make_part(const std::string& kind, const PartContext& context) {
  return row_of(kind, context).make(context);
}

std::unique_ptr<Part> make_real_part(const std::string& kind, const PartContext& context,
                                     powercube::BusConnection& line, const RealOptions& options) {
  return row_of(kind, context).make_real(context, line, options);
}

}  // namespace visum::hwparts
