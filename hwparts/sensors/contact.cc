// The kind `contact`: a bumper. `Contact` is 1 while the force is above `threshold`.
#include "hwparts/sensors/motion_sensors.h"

namespace visum::sensors {
namespace {

class Bumper : public Sensor {
 public:
  Bumper(const SensorContext& context, Layout layout, double threshold_n)
      : Sensor(context, std::move(layout)), threshold_n_(threshold_n) {}

 protected:
  void show(std::span<const double> reading, std::span<double> outputs) override {
    outputs[0] = reading[0] > threshold_n_ ? 1.0 : 0.0;
    outputs[1] = reading[0];
  }

 private:
  double threshold_n_;
};

}  // namespace

std::unique_ptr<Sensor> make_contact(const SensorContext& context) {
  constexpr double kLargest_n = 1e6;
  allow_keys(context.config, {"body", "range", "threshold", "noise", "noise_share", "bias", "resolution"});
  const double range = context.config.number_or("range", kLargest_n, {0.0, kLargest_n, true});
  const double threshold = context.config.number_or("threshold", 0.0, {0.0, range});
  Layout layout{
      "contact",
      {{"Contact", "", 0.0, 1.0, 0.0, "Contact"}, {"Normal Force", "N", 0.0, range, 0.0, "Normal Force"}},
      {},
      {read_accuracy(context.config, 0.0, range)}};
  return std::make_unique<Bumper>(context, std::move(layout), threshold);
}

}  // namespace visum::sensors
