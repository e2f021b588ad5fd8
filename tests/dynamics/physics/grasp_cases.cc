// G: a gripper of two sliding jaws.
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/contact_models.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;

constexpr double kEdge = 0.1, kTall = 0.3;

// `count` cubes of 1 kg in a row along x, a jaw at either end, on sliders; each jaw pushes with `squeeze_n`.
struct Grasp {
  Grasp(const world::EngineSetting& engine, double tick_s, int count, double squeeze_n, double friction)
      : lab(model(engine, tick_s, count, friction)) {
    lab.drive("slide_left").feedforward = squeeze_n;
    lab.drive("slide_right").feedforward = -squeeze_n;
  }

  static world::WorldModel model(const world::EngineSetting& engine, double tick_s, int count,
                                 double friction) {
    ModelBuilder b(engine);
    b.model.tick_ns = std::llround(1e9 * tick_s);
    const auto surface = b.add_surface(friction, 0.0);
    constexpr double kPitch = kEdge - kTouch;
    const double half = 0.5 * kPitch * (count + 1);
    const auto jaw = [&](const std::string& side, double x) {
      const auto id = b.add_box("jaw_" + side, {kEdge, kTall, kTall}, 1.0, at(x, 0, 1), surface);
      b.add_joint("slide_" + side, world::JointKind::kSlider, {}, id, {x, 0, 1}, Vector3d::UnitX());
    };
    jaw("left", -half);
    jaw("right", half);
    for (int i = 0; i < count; ++i)
      b.add_box("block_" + std::to_string(i), Vector3d::Constant(kEdge), 1.0,
                at(kPitch * (i - 0.5 * (count - 1)), 0, 1), surface);
    return b.model;
  }

  double slip_m(std::size_t block) const { return std::abs(lab.state.bodies[2 + block].p_WC.z() - 1.0); }

  Lab lab;
};

// The largest slip for each count of blocks, and how many of all blocks were dropped: slipped by their own
// height. How far those have fallen since says nothing.
std::vector<double> slips(const world::EngineSetting& engine, double tick_s, double seconds,
                          const std::vector<int>& counts) {
  std::vector<double> figures;
  double dropped = 0.0;
  for (const int count : counts) {
    Grasp grasp(engine, tick_s, count, 100.0 * count, 0.5);
    grasp.lab.run(seconds);
    double largest = 0.0;
    for (int i = 0; i < count; ++i) {
      const double slip = grasp.slip_m(static_cast<std::size_t>(i));
      largest = std::max(largest, std::min(slip, kEdge));
      if (slip >= kEdge) ++dropped;
    }
    figures.push_back(largest);
  }
  figures.push_back(dropped);
  return figures;
}

std::vector<double> hold(const world::EngineSetting& engine) {
  return slips(engine, 1e-3, 1.0, {1, 3, 5, 11});
}

std::vector<double> hold_coarsely(const world::EngineSetting& engine) {
  return slips(engine, 5e-3, 1.0, {1, 3, 5, 11});
}

std::vector<double> hold_for_long(const world::EngineSetting& engine) {
  return slips(engine, 1e-3, 100.0, {1, 3, 5, 7, 9, 11});
}

std::vector<double> hold_for_long_coarsely(const world::EngineSetting& engine) {
  return slips(engine, 5e-3, 100.0, {1, 3, 5, 7, 9, 11});
}

// W = 2 μ N is the limit: one block, with friction a little above and a little below.
std::vector<double> hold_at_the_edge(const world::EngineSetting& engine) {
  constexpr double kSqueeze = 50.0, kCritical = kG / (2.0 * kSqueeze);
  Grasp held(engine, 1e-3, 1, kSqueeze, 1.01 * kCritical), lost(engine, 1e-3, 1, kSqueeze, 0.99 * kCritical);
  held.lab.run(1.0);
  lost.lab.run(1.0);
  const double fall = 0.5 * 0.01 * kG;  // friction does not carry this part, for 1 s
  return {held.slip_m(0), std::abs(lost.slip_m(0) / fall - 1.0)};
}

}  // namespace

std::vector<Case> grasp_cases() {
  const std::vector<Figure> few{
      {"slip_1_m", 1e-3}, {"slip_3_m", 1e-3}, {"slip_5_m", 1e-3}, {"slip_11_m", 1e-3}, {"dropped", 0.0}};
  const std::vector<Figure> many{{"slip_1_m", 1e-3}, {"slip_3_m", 1e-3}, {"slip_5_m", 1e-3},
                                 {"slip_7_m", 1e-3}, {"slip_9_m", 1e-3}, {"slip_11_m", 1e-3},
                                 {"dropped", 0.0}};
  const char* source = "closed form: friction carries ten times the weight: no slip";
  return {
      {"G1", "JawsHoldBlocks", source, few, hold},
      {"G1c", "JawsHoldBlocksIn5msSteps", source, few, hold_coarsely},
      {"G1l", "JawsHoldBlocksFor100s", source, many, hold_for_long, true},
      {"G1lc", "JawsHoldBlocksFor100sIn5msSteps", source, many, hold_for_long_coarsely, true},
      {"G2",
       "FrictionHoldsTheBlockToTheEdge",
       "closed form: holds at 1.01 W / 2N; falls at g/100 at 0.99",
       {{"slip_m", 1e-5}, {"fall", 1e-2}},
       hold_at_the_edge},
  };
}

}  // namespace visum::physics
