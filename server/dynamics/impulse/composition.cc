#include "server/dynamics/impulse/composition.h"

#include <algorithm>
#include <array>

namespace visum::dynamics::impulse {
namespace {

constexpr std::array kOnce{1.0};

constexpr double kS = 0.41449077179437573714;  // 1/(4 - 4^(1/3))
constexpr std::array kSuzuki{kS, kS, 1.0 - 4.0 * kS, kS, kS};

// Yoshida's solution A, in his order w1, w2, w3; w0 makes the sum one.
constexpr double kY1 = 0.78451361047755726382, kY2 = 0.23557321335935813368, kY3 = -1.17767998417887100695;
constexpr double kY0 = 1.0 - 2.0 * (kY1 + kY2 + kY3);
constexpr std::array kYoshida{kY1, kY2, kY3, kY0, kY3, kY2, kY1};

// True if nothing happens that a step back in time would not undo.
bool may_go_back(const Plant& plant, double h) {
  if (!plant.touches.empty()) return false;
  for (std::size_t m = 0; m < plant.mechanisms.size(); ++m)
    if (!plant.mechanism_asleep[m] && plant.mechanisms[m].is_nearly_singular()) return false;
  const bool free_axes = std::none_of(plant.axes.begin(), plant.axes.end(), [h](const Axis& axis) {
    return axis.acts || axis.damping > 0.0 || is_within_reach(axis, 0, h) || is_within_reach(axis, 1, h);
  });
  return free_axes && std::all_of(plant.springs.begin(), plant.springs.end(),
                                  [](const Spring& spring) { return spring.spec.model->damping == 0.0; });
}

}  // namespace

std::span<const double> stages(const Plant& plant, double h) {
  if (plant.setting.order == 2 || !may_go_back(plant, h)) return kOnce;
  if (plant.setting.order == 4) return kSuzuki;
  return kYoshida;
}

}  // namespace visum::dynamics::impulse
