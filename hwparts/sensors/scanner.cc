// The kind `scanner`: many rays in a fan. The blackboard `scan` has all distances, as 32-bit floats in m,
// first ray first. An end of the range means that the ray meets nothing, or something too near. The ports
// show the nearest distance.
#include <algorithm>

#include "hwparts/sensors/range_finder.h"

namespace visum::sensors {
namespace {

class Scanner : public Sensor {
 public:
  Scanner(const SensorContext& context, Layout layout, std::vector<double> beams)
      : Sensor(context, std::move(layout)),
        beams_(std::move(beams)),
        scan_(beams_.size(), static_cast<float>(accuracy(0).highest)) {}

  std::span<const std::byte> read_blackboard(std::size_t) const override {
    return std::as_bytes(std::span(scan_));
  }

 protected:
  void show(std::span<const double> reading, std::span<double> outputs) override {
    shown_again(reading);
    const auto inside = [this](double m) { return m > accuracy(0).lowest && m < accuracy(0).highest; };
    const auto nearest = std::ranges::min_element(reading);
    outputs[0] = *nearest;
    outputs[1] = beams_[static_cast<std::size_t>(nearest - reading.begin())];
    outputs[2] = static_cast<double>(std::ranges::count_if(reading, inside));
  }
  void shown_again(std::span<const double> reading) override {
    std::ranges::transform(reading, scan_.begin(), [](double m) { return static_cast<float>(m); });
  }
  bool fills_blackboard() const override { return true; }

 private:
  std::vector<double> beams_;  // rad
  std::vector<float> scan_;    // m
};

}  // namespace

std::unique_ptr<Sensor> make_scanner(const SensorContext& context) {
  allow_keys(context.config,
             {"body", "pose", "range", "rays", "angle", "noise", "noise_share", "bias", "resolution"});
  const Reach reach = read_reach(context.config);
  std::vector<double> beams = read_beams(context.config);
  const Accuracy accuracy = read_accuracy(context.config, reach.lowest_m, reach.highest_m);
  const std::size_t rays = beams.size();
  Layout layout{"scanner",
                {{"Nearest Distance", "m", reach.lowest_m, reach.highest_m, reach.highest_m, "Nearest"},
                 {"Nearest Angle", "rad", beams.front(), beams.back(), beams.front(), "Nearest"},
                 {"Rays In Range", "", 0.0, static_cast<double>(rays), 0.0, "Rays In Range"}},
                {{"scan", "application/x-float32", sizeof(float), rays, rays * sizeof(float), false}},
                std::vector<Accuracy>(rays, accuracy),
                reach.highest_m};
  return std::make_unique<Scanner>(context, std::move(layout), std::move(beams));
}

}  // namespace visum::sensors
