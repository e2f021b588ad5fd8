// G3: the gripper of two sliders takes a block from the ground, lifts it, shakes it, and lets it go.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/contact_models.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;
using world::JointKind;

constexpr double kCube = 0.1, kClose = 2.0, kSqueeze = 50.0, kOpen = 0.5, kLift = 0.2;  // m, N, N, N, m
constexpr double kShake = 0.02, kShakes = 2.0 * std::numbers::pi * 2.0;                 // m, rad/s: 3.2 m/s²
constexpr double kAxisN = 2000.0;  // N, of the axes that carry

// `sway` (along y) carries `lift` (along z), which carries both jaws (along x).
world::WorldModel crane(const world::EngineSetting& engine, double tick_s) {
  ModelBuilder b(engine);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  const auto surface = b.add_surface(0.5, 0.0);
  b.add_ground(surface);
  const auto cart = b.add_rotor("cart", 2.0, 0.05, at(0, 0, 0.8));
  const auto palm = b.add_rotor("palm", 1.0, 0.02, at(0, 0, 0.5));
  b.add_joint("sway", JointKind::kSlider, {}, cart, {0, 0, 0.8}, Vector3d::UnitY());
  b.add_joint("lift", JointKind::kSlider, cart, palm, {0, 0, 0.5}, Vector3d::UnitZ());
  const auto jaw = [&](const std::string& side, double x) {
    const auto id = b.add_box("jaw_" + side, {0.04, 0.1, 0.08}, 0.3, at(x, 0, 0.06), surface);
    b.add_joint("slide_" + side, JointKind::kSlider, palm, id, {x, 0, 0.06}, Vector3d::UnitX());
  };
  jaw("left", -0.1);
  jaw("right", 0.1);
  b.add_box("block", Vector3d::Constant(kCube), 1.0, at(0, 0, 0.5 * kCube - kTouch), surface);
  return b.model;
}

struct Crane {
  Crane(const world::EngineSetting& engine, double tick_s) : lab(crane(engine, tick_s)) {}

  // Runs for this long, with the jaws' force and the axes' speeds over time.
  template <typename Sway, typename Up, typename Look>
  void run(double seconds, double squeeze_n, Sway sway, Up up, Look look) {
    const long ticks = std::lround(seconds / lab.tick_s());
    for (long i = 0; i < ticks; ++i) {
      const double t = (static_cast<double>(i) + 0.5) * lab.tick_s();
      lab.drive("sway") = {sway(t), 0.0, kAxisN, 0.0};
      lab.drive("lift") = {up(t), 0.0, kAxisN, 0.0};
      lab.drive("slide_left").feedforward = squeeze_n;
      lab.drive("slide_right").feedforward = -squeeze_n;
      lab.run_ticks(1);
      look();
    }
  }
  // The block's place against the jaws. Together they may move along their slides: nothing holds them there.
  Vector3d grip() {
    return lab.body("block").p_WC - 0.5 * (lab.body("jaw_left").p_WC + lab.body("jaw_right").p_WC);
  }

  Lab lab;
};

std::vector<double> lift_shake_release_at(const world::EngineSetting& engine, double tick_s) {
  Crane crane(engine, tick_s);
  const auto still = [](double) { return 0.0; };
  const auto nothing = [] {};
  crane.run(0.3, kClose, still, still, nothing);
  crane.run(0.2, kSqueeze, still, still, nothing);
  const Vector3d gripped = crane.grip();
  double slip = 0.0;
  const auto look = [&] { slip = std::max(slip, (crane.grip() - gripped).norm()); };
  const auto rise = [](double t) { return kLift * (1.0 - std::cos(2.0 * std::numbers::pi * t)); };
  crane.run(1.0, kSqueeze, still, rise, look);
  const double low = 0.5 * kCube;
  const double high = std::abs(crane.lab.body("block").p_WC.z() - low - kLift);
  const auto shake = [](double t) { return kShake * kShakes * std::sin(kShakes * t); };
  crane.run(2.0, kSqueeze, shake, still, look);
  crane.run(0.8, -kOpen, still, still, nothing);
  const auto& block = crane.lab.body("block");
  return {slip, high, std::abs(block.p_WC.z() - low), block.v_WC.norm() + block.w_WB.norm()};
}

std::vector<double> lift_shake_release(const world::EngineSetting& engine) {
  return lift_shake_release_at(engine, 1e-3);
}

std::vector<double> lift_shake_release_coarsely(const world::EngineSetting& engine) {
  return lift_shake_release_at(engine, 5e-3);
}

}  // namespace

std::vector<Case> lift_cases() {
  const std::vector<Figure> figures{
      {"slip_m", 1e-3}, {"lift_m", 1e-3}, {"rest_m", 1e-3}, {"rest_m_per_s", 1e-3}};
  const char* source =
      "closed form: friction carries four times the load: no slip; let go, it falls and lies";
  return {
      {"G3", "GripperLiftsShakesAndReleases", source, figures, lift_shake_release},
      {"G3c", "GripperLiftsShakesAndReleasesIn5msSteps", source, figures, lift_shake_release_coarsely},
  };
}

}  // namespace visum::physics
