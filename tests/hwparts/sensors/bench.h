// One sensor on a bench: made from its entry as a text, with truths from the test and ports by name.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "hwparts/sensors/sensor_kinds.h"

namespace visum::sensors::test {

class Bench {
 public:
  static constexpr std::int64_t kTick_ns = 1'000'000;

  explicit Bench(const std::string& yaml, std::uint64_t seed = 1) {
    const auto config = config::load_text("{name: it, " + yaml + "}", "sensor");
    sensor = make_sensor(config.get("kind").text(), {"it", config, kTick_ns, seed});
    reset();
  }

  void reset() {
    sensor->reset();
    outputs.clear();
    for (const auto& port : sensor->description().sensor_outputs) outputs.push_back(port.initial);
  }
  // One tick with this truth. Its last number is repeated where the sensor needs more.
  void tick(const std::vector<double>& truth) {
    if (sensor->due())
      for (std::size_t i = 0; i < sensor->truth().size(); ++i)
        sensor->truth()[i] = truth[std::min(i, truth.size() - 1)];
    sensor->publish({}, outputs);
  }
  double port(const std::string& name) const {
    const auto& ports = sensor->description().sensor_outputs;
    for (std::size_t i = 0; i < ports.size(); ++i)
      if (ports[i].name == name) return outputs[i];
    throw std::runtime_error("no port " + name);
  }
  void fail(const std::string& how) {
    if (auto reason = sensor->set_parameter("Failure", how)) throw std::runtime_error(*reason);
  }

  std::unique_ptr<Sensor> sensor;
  std::vector<double> outputs;
};

// The mean and standard deviation of some numbers.
struct Statistics {
  double mean = 0.0, deviation = 0.0;
};
inline Statistics statistics_of(const std::vector<double>& numbers) {
  Statistics s;
  for (const double x : numbers) s.mean += x / static_cast<double>(numbers.size());
  double sum = 0.0;
  for (const double x : numbers) sum += (x - s.mean) * (x - s.mean);
  s.deviation = std::sqrt(sum / static_cast<double>(numbers.size() - 1));
  return s;
}

}  // namespace visum::sensors::test
