// K4, K5: restitution.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/physics/case.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;

constexpr double kRadius = 0.1, kHeight = 1.0;

// A ball over the plane, let go at a height of 1 m.
Lab falling_ball(const world::EngineSetting& engine, double restitution) {
  ModelBuilder b(engine);
  const auto surface = b.add_surface(0.3, restitution);
  b.add_ground(surface);
  b.add_sphere("ball", kRadius, 1.0, at(0, 0, kRadius + kHeight), surface);
  return Lab(b.model);
}

// Height of the apex after the first bounce, from height and speed at any time of the flight.
double first_apex(const world::EngineSetting& engine, double restitution) {
  Lab lab = falling_ball(engine, restitution);
  lab.run(0.5);
  const auto& ball = lab.body("ball");
  return ball.p_WC.z() - kRadius + 0.5 * ball.v_WC.z() * std::abs(ball.v_WC.z()) / kG;
}

std::vector<double> bounce(const world::EngineSetting& engine) {
  double worst = 0.0;
  for (const double e : {0.4, 0.6, 0.8, 1.0})
    worst = std::max(worst, std::abs(first_apex(engine, e) - e * e));
  return {std::abs(first_apex(engine, 0.8) - 0.64), worst, std::abs(first_apex(engine, 0.0))};
}

std::vector<double> bounce_for_ever(const world::EngineSetting& engine) {
  Lab lab = falling_ball(engine, 1.0);
  const auto energy = [&] { return lab.kinetic_energy() + kG * (lab.body("ball").p_WC.z() - kRadius); };
  const double start = energy();
  double gained = 0.0;
  watch(lab, 10.0, [&] { gained = std::max(gained, energy() / start - 1.0); });
  return {std::abs(energy() / start - 1.0), gained};
}

}  // namespace

std::vector<Case> bounce_cases() {
  return {
      {"K4",
       "BallBouncesToESquared",
       "closed form: apex e² h",
       {{"apex_08_m", 1e-4}, {"apex_m", 1e-4}, {"apex_0_m", 1e-4}},
       bounce},
      {"K5",
       "ElasticBallKeepsItsEnergy",
       "closed form: E constant over 10 s",
       {{"energy", 1e-6}, {"gain", 1e-6}},
       bounce_for_ever},
  };
}

}  // namespace visum::physics
