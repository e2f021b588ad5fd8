#include "tests/dynamics/physics/case.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

std::vector<Case> all_cases() {
  std::vector<Case> all;
  for (const auto letter :
       {free_cases,    flip_cases,        pendulum_cases, accuracy_cases,  coarse_cases,  chain_cases,
        heavy_cases,   loop_cases,        kind_cases,     kind_pair_cases, sliding_cases, bounce_cases,
        crowd_cases,   balance_cases,     legged_cases,   grasp_cases,     lift_cases,    servo_cases,
        anytime_cases, determinism_cases, standing_cases})
    for (Case& one : letter()) all.push_back(std::move(one));
  return all;
}

}  // namespace

const std::vector<Case>& cases() {
  static const std::vector<Case> all = all_cases();
  return all;
}

const Case& find_case(const std::string& id) {
  const auto found = std::ranges::find(cases(), id, &Case::id);
  if (found == cases().end()) throw std::runtime_error("there is no case '" + id + "'");
  return *found;
}

std::vector<double> run(const Case& what, const world::EngineSetting& engine) {
  constexpr double kBroken = std::numeric_limits<double>::infinity();
  std::vector<double> figures;
  try {
    figures = what.measure(engine);
  } catch (const std::runtime_error&) {
    return std::vector<double>(what.figures.size(), kBroken);
  }
  if (figures.size() != what.figures.size())
    throw std::logic_error(std::string(what.id) + " returned another number of figures than it names");
  for (double& figure : figures)
    if (std::isnan(figure)) figure = kBroken;
  return figures;
}

void watch(Lab& lab, double seconds, const std::function<void()>& look) {
  const long ticks = std::lround(seconds / lab.tick_s());
  for (long i = 0; i < ticks; ++i) {
    lab.run_ticks(1);
    look();
  }
}

double watch_energy_rise(Lab& lab, double seconds) {
  double least = energy_of(lab.model, lab.state), rise = 0.0;
  watch(lab, seconds, [&] {
    const double now = energy_of(lab.model, lab.state);
    rise = std::max(rise, now - least);
    least = std::min(least, now);
  });
  return rise;
}

double deepest(const std::vector<collision::Contact>& contacts) {
  double depth = 0.0;
  for (const auto& contact : contacts) depth = std::max(depth, contact.depth);
  return depth;
}

}  // namespace visum::physics
