// The kind `pose`: place and orientation of the sensor's frame, as a tracker or a satellite receiver with a
// compass gives them. The orientation's noise is a small turn about a random axis in the sensor's frame.
#include <algorithm>
#include <array>
#include <cmath>

#include "hwparts/sensors/axes.h"
#include "hwparts/sensors/motion_sensors.h"

namespace visum::sensors {
namespace {

constexpr std::size_t kOrientation = 3;  // behind the place

using Quaternion = std::array<double, 4>;  // w x y z

Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

class PoseSensor : public Sensor {
 public:
  PoseSensor(const SensorContext& context, Layout layout, double turn_noise_rad)
      : Sensor(context, std::move(layout)), turn_noise_rad_(turn_noise_rad) {}

 protected:
  void read(std::span<const double> truth, std::span<double> reading, Random& random) const override {
    Sensor::read(truth, reading, random);
    if (turn_noise_rad_ == 0.0) return;
    Quaternion seen{};
    std::ranges::copy(truth.subspan(kOrientation), seen.begin());
    // Half the turn is the vector part. Normalised, that is exact up to the noise's third power.
    Quaternion turn{1.0};
    for (std::size_t axis = 1; axis < 4; ++axis) turn[axis] = 0.5 * turn_noise_rad_ * random.normal();
    seen = product(seen, turn);
    double square = 0.0;
    for (const double part : seen) square += part * part;
    const double norm = std::sqrt(square);
    for (std::size_t i = 0; i < seen.size(); ++i) reading[kOrientation + i] = seen[i] / norm;
  }

 private:
  double turn_noise_rad_;  // standard deviation about each axis
};

}  // namespace

std::unique_ptr<Sensor> make_pose(const SensorContext& context) {
  constexpr double kFarthest_m = 1e6, kMostTurnNoise_rad = 0.5;
  allow_keys(context.config, {"body", "pose", "position", "orientation"});
  Layout layout{"pose", {}, {}, {}};
  add_axes(layout, "Position", "m", read_symmetric(context.config, "position", kFarthest_m));
  double turn_noise_rad = 0.0;
  if (const auto orientation = context.config.find("orientation")) {
    orientation->allow_only({"noise"});
    turn_noise_rad = orientation->number_or("noise", 0.0, {0.0, kMostTurnNoise_rad});
  }
  for (const char* part : {" W", " X", " Y", " Z"}) {
    layout.ports.push_back({std::string("Orientation") + part, "", -1.0, 1.0, 0.0, "Orientation"});
    layout.numbers.push_back({-1.0, 1.0});
  }
  return std::make_unique<PoseSensor>(context, std::move(layout), turn_noise_rad);
}

}  // namespace visum::sensors
