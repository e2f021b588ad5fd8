#include "hwparts/sensors/sensor_kinds.h"

#include <array>

#include "hwparts/sensors/camera.h"
#include "hwparts/sensors/motion_sensors.h"
#include "hwparts/sensors/range_finder.h"

namespace visum::sensors {
namespace {

constexpr std::array<SensorKind, 7> kKinds{{
    {"distance", "distance along one ray", make_distance},
    {"scanner", "distance along each ray of a fan", make_scanner},
    {"imu", "angular rate and acceleration", make_imu},
    {"pose", "place and orientation in the world", make_pose},
    {"contact", "contact with something, and its force", make_contact},
    {"joint_wrench", "force and torque through a joint", make_joint_wrench},
    {"camera", "pictures of colours, depths, or bodies", make_camera},
}};

}  // namespace

std::span<const SensorKind> sensor_kinds() {
  return kKinds;
}

std::unique_ptr<Sensor> make_sensor(const std::string& kind, const SensorContext& context) {
  std::vector<std::string> names;
  for (const auto& row : kKinds) {
    if (kind == row.name) return row.make(context);
    names.emplace_back(row.name);
  }
  context.config.get("kind").one_of(names);  // throws, and suggests a name
  throw std::logic_error("the kind of a sensor is not its entry's");
}

}  // namespace visum::sensors
