// C4, C5: heavy ends of light chains, in ticks that are coarse for them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using Eigen::Vector3d;

constexpr double kBroken = std::numeric_limits<double>::infinity();

struct EnergyCourse {
  double off = kBroken;   // the largest relative deviation
  double rise = kBroken;  // above the smallest value before
};

// Infinite where the engine reports a fault.
EnergyCourse energy_course(world::WorldModel model, double scale, double seconds) {
  try {
    Lab lab(std::move(model));
    const double energy = energy_of(lab.model, lab.state);
    double off = 0.0, rise = 0.0, least = energy;
    watch(lab, seconds, [&] {
      const double now = energy_of(lab.model, lab.state);
      off = std::max(off, std::abs(now - energy) / scale);
      rise = std::max(rise, (now - least) / scale);
      least = std::min(least, now);
    });
    return {off, rise};
  } catch (const std::runtime_error&) {
    return {};
  }
}

std::vector<double> swing_heavy_tip(const world::EngineSetting& engine) {
  std::vector<double> figures;
  for (const double tick_s : {2e-3, 4e-3}) {
    auto model = chain(engine, tick_s, 8);
    auto& tip = model.bodies.back();
    tip.mass_kg *= 1000.0;
    tip.inertia_C *= 1000.0;
    const double scale = energy_scale(model);
    figures.push_back(energy_course(std::move(model), scale, 5.0).off);
  }
  return figures;
}

// Eight capsules on hinges, their axes alternating, the last with 100 times the mass, the first half a metre
// above the ground. They lie along x, or stand with the heavy one on top.
constexpr double kCapsule = 0.02, kCapsuleLength = 0.1, kAbove = 0.5, kCapsuleKg = 0.2;

world::WorldModel falling_capsules(const world::EngineSetting& engine, double tick_s, bool upright) {
  dynamics::testing::ModelBuilder b(engine);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  b.add_ground();
  const double lean = upright ? 0.0 : 0.5 * std::numbers::pi;
  const Vector3d along = upright ? Vector3d::UnitZ() : Vector3d::UnitX();
  const Vector3d other = upright ? Vector3d::UnitX() : Vector3d::UnitZ(), start(0.0, 0.0, kAbove);
  for (int i = 0; i < 8; ++i) {
    const double mass = kCapsuleKg * (i == 7 ? 100.0 : 1.0);
    const Vector3d p = start + i * kCapsuleLength * along;
    const auto id = b.add_cylinder("link_" + std::to_string(i), kCapsule, kCapsuleLength - 2.0 * kCapsule,
                                   mass, at(p.x(), p.y(), p.z(), lean, Vector3d::UnitY()));
    b.model.shapes.back().kind = world::ShapeKind::kCapsule;
    b.body(id).inertia_C = solid_cylinder_inertia(mass, kCapsule, kCapsuleLength).asDiagonal();
    if (i == 0) continue;
    b.add_joint("joint_" + std::to_string(i), world::JointKind::kHinge, {i}, id,
                p - 0.5 * kCapsuleLength * along, i % 2 == 1 ? Vector3d::UnitY() : other)
        .initial_position = 0.1 * (i % 3 - 1);
  }
  return b.model;
}

std::vector<double> fall(const world::EngineSetting& engine, bool upright) {
  constexpr double kScaleJ = 107.0 * kCapsuleKg * kG * kAbove;
  std::vector<double> figures;
  for (const double tick_s : {1e-3, 5e-3, 1e-2})
    figures.push_back(energy_course(falling_capsules(engine, tick_s, upright), kScaleJ, 1.0).rise);
  return figures;
}

std::vector<double> fall_lying(const world::EngineSetting& engine) {
  return fall(engine, false);
}

std::vector<double> fall_upright(const world::EngineSetting& engine) {
  return fall(engine, true);
}

}  // namespace

std::vector<Case> heavy_cases() {
  // At 3 m/s bodies sink in by 3 mm for each millisecond of a tick.
  const std::vector<Figure> rises{{"rise_1ms", 6e-3}, {"rise_5ms", 3e-2}, {"rise_10ms", 6e-2}};
  const char* source = "closed form: E falls, and rises by no more than it takes to lift what has sunk in";
  return {
      {"C4",
       "TipOf1000TimesTheMassSwingsInCoarseTicks",
       "closed form: E constant; chain of 8 for 5 s",
       {{"energy_2ms", 1e-2}, {"energy_4ms", 1e-2}},
       swing_heavy_tip},
      {"C5", "LyingChainWithAHeavyEndFalls", source, rises, fall_lying},
      {"C5u", "ChainUnderAHeavyEndFalls", source, rises, fall_upright},
  };
}

}  // namespace visum::physics
