// A sensor as an outside project would write it: an ultrasonic ranger, which hears the nearest thing within a
// cone around its x axis.
#include <visum/plugin.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace visum::plugin;

class Sonar final : public Sensor {
 public:
  explicit Sonar(SensorContext& scene)
      : farthest_m_(scene.settings().number("farthest", 0.1, 100.0)),
        half_angle_(scene.settings().number_or("half_angle", 0.26, 0.01, 1.0)) {
    scene.add_output({"Distance", "m", 0.0, farthest_m_, farthest_m_});
    scene.wants_rays();
  }

  void measure(const Truth& truth, std::span<double> numbers) const override {
    constexpr int kRings = 4, kRaysPerRing = 12;
    constexpr double kPi = 3.14159265358979323846;
    constexpr double kAhead[] = {1.0, 0.0, 0.0};
    double nearest = truth.distance(kAhead, farthest_m_);
    for (int ring = 1; ring <= kRings; ++ring) {
      const double off = half_angle_ * ring / kRings;
      for (int i = 0; i < kRaysPerRing; ++i) {
        const double about = 2.0 * kPi * i / kRaysPerRing;
        const double ray[] = {std::cos(off), std::sin(off) * std::cos(about),
                              std::sin(off) * std::sin(about)};
        nearest = std::min(nearest, truth.distance(ray, farthest_m_));
      }
    }
    numbers[0] = nearest;
  }

 private:
  const double farthest_m_, half_angle_;
};

constexpr SensorKind kSensors[] = {{"sonar", "the nearest thing within a cone", make_sensor<Sonar>}};

}  // namespace

VISUM_PLUGIN({.name = "sonar", .version = "1.0", .sensors = kSensors})
