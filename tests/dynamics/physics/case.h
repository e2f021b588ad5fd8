// The physics suite. Each case sets a world up, lets an engine run it, and returns a few figures. All of them
// are errors: 0 is perfect, and up to the demand is right. expectations.cc says which engine is expected to
// reach what. The test and the table (physics_table.cc) run the same cases.
#pragma once

#include <array>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "tests/dynamics/lab.h"

namespace visum::physics {

using dynamics::testing::Lab;

inline constexpr double kG = 9.81;                           // m/s^2
inline constexpr double kDegree = std::numbers::pi / 180.0;  // rad

// A figure and what is demanded of it. Higher orders may have demands of their own. An engine without orders
// is held to the demand on order 2.
struct Figure {
  Figure(const char* figure_name, double demanded) : Figure(figure_name, demanded, demanded, demanded) {}
  Figure(const char* figure_name, double order2, double order4, double order6)
      : name(figure_name), demands{order2, order4, order6} {}

  double demand(const world::EngineSetting& engine) const {
    return demands[engine.order == 6 ? 2 : engine.order == 4 ? 1 : 0];
  }
  double demand(const std::string& row) const {
    return demands[row == "impulse-order6" ? 2 : row == "impulse-order4" ? 1 : 0];
  }

  const char* name;  // with its unit: "tip_1s_m"
  std::array<double, 3> demands;
};

// The largest gap of joints that close no loop: d_max by order, see server/dynamics/impulse/README.md.
inline Figure gap_figure(const char* name) {
  return {name, 1e-7, 1e-10, 1e-13};
}

struct Case {
  const char* id;      // letter and number: F free, P pendulums, C chains, L loops, J joints, K contacts, G
                       // grasps, S servos, A anytime, D determinism
  const char* claim;   // as a test's name
  const char* source;  // the closed form, or the source of the reference values
  std::vector<Figure> figures;
  std::vector<double> (*measure)(const world::EngineSetting& engine);
  bool takes_long = false;  // not in the default run
};

std::vector<Case> free_cases();
std::vector<Case> flip_cases();
std::vector<Case> pendulum_cases();
std::vector<Case> accuracy_cases();
std::vector<Case> coarse_cases();
std::vector<Case> chain_cases();
std::vector<Case> heavy_cases();
std::vector<Case> loop_cases();
std::vector<Case> kind_cases();
std::vector<Case> kind_pair_cases();
std::vector<Case> sliding_cases();
std::vector<Case> bounce_cases();
std::vector<Case> balance_cases();
std::vector<Case> crowd_cases();
std::vector<Case> standing_cases();
std::vector<Case> legged_cases();
std::vector<Case> grasp_cases();
std::vector<Case> lift_cases();
std::vector<Case> servo_cases();
std::vector<Case> anytime_cases();
std::vector<Case> determinism_cases();

const std::vector<Case>& cases();
// Throws std::runtime_error for an unknown id.
const Case& find_case(const std::string& id);

// The case's figures. All are infinite if the engine reports a fault; one that is not a number becomes
// infinite.
std::vector<double> run(const Case& what, const world::EngineSetting& engine);

// Runs ticks for `seconds`, and calls `look` after each.
void watch(Lab& lab, double seconds, const std::function<void()>& look);

// The same; returns by how much the energy has risen above its smallest value before, J.
double watch_energy_rise(Lab& lab, double seconds);
double deepest(const std::vector<collision::Contact>& contacts);  // overlap, m

}  // namespace visum::physics
