// K4, K5: restitution.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"

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
  for (const double e : {0.2, 0.4, 0.6, 0.8, 1.0})
    worst = std::max(worst, std::abs(first_apex(engine, e) - e * e));
  return {std::abs(first_apex(engine, 0.8) - 0.64), worst, std::abs(first_apex(engine, 0.0))};
}

// The apexes of the first five bounces; the k-th is e^2k.
std::vector<double> bounce_on(const world::EngineSetting& engine) {
  constexpr double kE = 0.8;
  Lab lab = falling_ball(engine, kE);
  const auto& ball = lab.body("ball");
  double worst = 0.0, before = 0.0, exact = 1.0;
  int bounces = 0;
  watch(lab, 3.2, [&] {
    const double speed = ball.v_WC.z();
    if (before < 0.0 && speed > 0.0 && bounces < 5) {
      exact *= kE * kE;
      ++bounces;
      worst = std::max(worst, std::abs((ball.p_WC.z() - kRadius + 0.5 * speed * speed / kG) / exact - 1.0));
    }
    before = speed;
  });
  return {worst, 5.0 - bounces};
}

std::vector<double> bounce_for_ever(const world::EngineSetting& engine) {
  Lab lab = falling_ball(engine, 1.0);
  const auto energy = [&] { return lab.kinetic_energy() + kG * (lab.body("ball").p_WC.z() - kRadius); };
  const double start = energy();
  double gained = 0.0;
  watch(lab, 10.0, [&] { gained = std::max(gained, energy() / start - 1.0); });
  return {std::abs(energy() / start - 1.0), gained};
}

// All balls do the same. Returns {largest change of energy, largest difference in height}.
std::vector<double> bounce_together(const world::EngineSetting& engine) {
  constexpr double kBall = 0.5, kDrop = 5.0;
  ModelBuilder b(engine);
  const auto surface = b.add_surface(0.3, 1.0);
  b.add_ground(surface);
  for (int i = 0; i < 49; ++i)
    b.add_sphere("ball_" + std::to_string(i), kBall, 10.0, at(2.0 * (i % 7), 2.0 * (i / 7), kBall + kDrop),
                 surface);
  Lab lab(b.model);
  const double scale = 49.0 * 10.0 * kG * kDrop, start = energy_of(lab.model, lab.state);
  double change = 0.0, apart = 0.0;
  watch(lab, 20.0, [&] {
    change = std::max(change, std::abs(energy_of(lab.model, lab.state) - start) / scale);
    for (const auto& body : lab.state.bodies)
      if (body.p_WC.z() > 0.0)
        apart = std::max(apart, std::abs(body.p_WC.z() - lab.state.bodies.back().p_WC.z()));
  });
  return {change, apart};
}

}  // namespace

std::vector<Case> bounce_cases() {
  return {
      {"K4",
       "BallBouncesToESquared",
       "closed form: apex e² h",
       {{"apex_08_m", 1e-4}, {"apex_m", 1e-4}, {"apex_0_m", 1e-4}},
       bounce},
      {"K4k",
       "KthBounceReachesEToThe2K",
       "closed form: apex e^2k h, five bounces with e = 0.8",
       {{"apex", 1e-4}, {"bounces_missed", 0.0}},
       bounce_on},
      {"K5",
       "ElasticBallKeepsItsEnergy",
       "closed form: E constant over 10 s",
       {{"energy", 1e-6}, {"gain", 1e-6}},
       bounce_for_ever},
      {"K5n",
       "FortyNineElasticBallsKeepTheirEnergy",
       "SimBenchmark's bouncing: 7 x 7 balls of 10 kg from 5 m, 20 s; closed form: E constant",
       {{"energy", 1e-6}, {"apart_m", 1e-6}},
       bounce_together},
  };
}

}  // namespace visum::physics
