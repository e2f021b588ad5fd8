#include "hwparts/sensors/axes.h"
#include "hwparts/sensors/motion_sensors.h"

namespace visum::sensors {

std::unique_ptr<Sensor> make_imu(const SensorContext& context) {
  constexpr double kFastest_rad_s = 1e4, kHardest_m_s2 = 1e6;
  allow_keys(context.config, {"body", "pose", "gyro", "accelerometer"});
  Layout layout{"imu", {}, {}, {}};
  add_axes(layout, "Angular Rate", "rad/s", read_symmetric(context.config, "gyro", kFastest_rad_s));
  add_axes(layout, "Acceleration", "m/s²", read_symmetric(context.config, "accelerometer", kHardest_m_s2));
  return std::make_unique<Sensor>(context, std::move(layout));
}

}  // namespace visum::sensors
