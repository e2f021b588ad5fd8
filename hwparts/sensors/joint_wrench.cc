#include "hwparts/sensors/axes.h"
#include "hwparts/sensors/motion_sensors.h"

namespace visum::sensors {

std::unique_ptr<Sensor> make_joint_wrench(const SensorContext& context) {
  constexpr double kLargest = 1e6;
  allow_keys(context.config, {"joint", "force", "torque"});
  Layout layout{"joint_wrench", {}, {}, {}};
  add_axes(layout, "Force", "N", read_symmetric(context.config, "force", kLargest));
  add_axes(layout, "Torque", "N·m", read_symmetric(context.config, "torque", kLargest));
  return std::make_unique<Sensor>(context, std::move(layout));
}

}  // namespace visum::sensors
