// A controller sends a sine, and one of its commands is lost on the way: the last target holds, the joint
// lags by no more than that command was worth, and nothing jumps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <vector>

#include "server/cycle/simulation.h"
#include "server/scene/scene.h"

namespace visum::cycle {
namespace {

constexpr int kTicks = 2000, kPeriod = 10;        // of 1 ms
constexpr double kAmplitude = 0.2, kTurns = 0.5;  // rad, per second
constexpr double kPerCommand = kAmplitude * 2.0 * std::numbers::pi * kTurns * 1e-3 * kPeriod;  // rad, at most

class Sine {
 public:
  Sine()
      : simulation_(
            scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml")) {
    const auto& part = *simulation_.parts()[0].part;
    start_ = part.description().controller_inputs[0].initial;
    const auto& outputs = part.description().sensor_outputs;
    const auto is_actual = [](const auto& port) { return port.name == "Actual Angle 1"; };
    actual_ = static_cast<std::size_t>(std::ranges::find_if(outputs, is_actual) - outputs.begin());
    begin_ = simulation_.take_snapshot();
  }

  // The angle at each tick, without the command of that number.
  std::vector<double> run(std::optional<int> lost = {}) {
    EXPECT_TRUE(simulation_.restore_snapshot(begin_).done());
    std::vector<double> angles;
    for (int tick = 0; tick < kTicks; ++tick) {
      const double target =
          start_ + kAmplitude * (1.0 - std::cos(2.0 * std::numbers::pi * kTurns * 1e-3 * tick));
      if (tick % kPeriod == 0 && lost != tick / kPeriod) simulation_.write_inputs(0, 0, std::vector{target});
      simulation_.tick();
      angles.push_back(simulation_.parts()[0].sensor_outputs[actual_]);
    }
    return angles;
  }

 private:
  Simulation simulation_;
  double start_ = 0.0;
  std::size_t actual_ = 0;
  std::uint64_t begin_ = 0;
};

double largest_step(const std::vector<double>& angles) {
  double most = 0.0;
  for (std::size_t i = 1; i < angles.size(); ++i) most = std::max(most, std::abs(angles[i] - angles[i - 1]));
  return most;
}

TEST(LostCommand, MakesNoJumpWhereverInTheSineItIs) {
  Sine sine;
  const auto all = sine.run();
  const double usual = largest_step(all);
  const auto [least, most] = std::ranges::minmax(all);
  ASSERT_GT(most - least, 1.8 * kAmplitude) << "the joint follows";
  int felt = 0;  // not all are felt: at its ends the sine stands still, and one command less changes nothing
  for (int lost = 1; lost < kTicks / kPeriod; ++lost) {
    const auto angles = sine.run(lost);
    double apart = 0.0;
    for (std::size_t i = 0; i < angles.size(); ++i) apart = std::max(apart, std::abs(angles[i] - all[i]));
    if (apart > 0.1 * kPerCommand) ++felt;
    ASSERT_LT(apart, 1.5 * kPerCommand) << "without command " << lost;
    ASSERT_LT(largest_step(angles), 1.5 * usual) << "without command " << lost;
  }
  EXPECT_GT(felt, kTicks / kPeriod / 2);
}

}  // namespace
}  // namespace visum::cycle
