// The physics suite: each case sets a world up, lets an engine run it, and returns a few figures, all of them
// errors: 0 is perfect, and at most `demand` is right. Which engine is expected to reach what is in
// expectations.cc. The test and the table (physics_table.cc) run the same cases.
#pragma once

#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "tests/dynamics/lab.h"

namespace visum::physics {

using dynamics::testing::Lab;

inline constexpr double kG = 9.81;                           // m/s^2
inline constexpr double kDegree = std::numbers::pi / 180.0;  // rad

struct Figure {
  const char* name;  // with its unit: "tip_1s_m"
  double demand;
};

struct Case {
  const char* id;      // letter and number: F free, P pendulums, C chains, L loops, J joints, K contacts, G
                       // grasps, S servos, A anytime, D determinism
  const char* claim;   // as a test's name
  const char* source;  // the closed form, or where the reference values come from
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
std::vector<Case> crowd_cases();
std::vector<Case> legged_cases();
std::vector<Case> grasp_cases();
std::vector<Case> lift_cases();
std::vector<Case> servo_cases();
std::vector<Case> anytime_cases();
std::vector<Case> determinism_cases();

const std::vector<Case>& cases();
// Throws std::runtime_error for an id that no case has.
const Case& find_case(const std::string& id);

// The case's figures; all infinite where the engine reports a fault, one infinite where it is not a number.
std::vector<double> run(const Case& what, const world::EngineSetting& engine);

// Ticks for `seconds`, with `look` after each tick.
void watch(Lab& lab, double seconds, const std::function<void()>& look);

}  // namespace visum::physics
