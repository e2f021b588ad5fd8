// The kind `distance`: one ray, two ports. `In Range` is 1 where the reading is a distance. It is 0 where the
// reading is an end of the range, because the ray meets nothing, or something that is too near.
#include "hwparts/sensors/range_finder.h"

namespace visum::sensors {
namespace {

class Distance : public Sensor {
 public:
  using Sensor::Sensor;

 protected:
  void show(std::span<const double> reading, std::span<double> outputs) override {
    const bool inside = reading[0] > accuracy(0).lowest && reading[0] < accuracy(0).highest;
    outputs[0] = reading[0];
    outputs[1] = inside ? 1.0 : 0.0;
  }
};

}  // namespace

std::unique_ptr<Sensor> make_distance(const SensorContext& context) {
  allow_keys(context.config, {"body", "pose", "range", "noise", "noise_share", "bias", "resolution"});
  const Reach reach = read_reach(context.config);
  Layout layout{"distance",
                {{"Distance", "m", reach.lowest_m, reach.highest_m, reach.highest_m, "Distance"},
                 {"In Range", "", 0.0, 1.0, 0.0, "In Range"}},
                {},
                {read_accuracy(context.config, reach.lowest_m, reach.highest_m)},
                reach.highest_m};
  return std::make_unique<Distance>(context, std::move(layout));
}

}  // namespace visum::sensors
