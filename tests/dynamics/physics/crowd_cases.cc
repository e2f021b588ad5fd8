// K9, K10: many balls.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;

constexpr double kMarble = 0.1;

// SimBenchmark's "666": 6 x 6 x 6 balls of 10 kg, 1 cm between them, the lowest `height` over the plane.
world::WorldModel cube_of_balls(const world::EngineSetting& engine, double height, double restitution) {
  constexpr double kPitch = 0.21;
  ModelBuilder b(engine);
  const auto surface = b.add_surface(0.4, restitution);
  b.add_ground(surface);
  for (int z = 0; z < 6; ++z)
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 6; ++x)
        b.add_sphere("ball_" + std::to_string(36 * z + 6 * y + x), kMarble, 10.0,
                     at(kPitch * x, kPitch * y, height + kPitch * z), surface);
  return b.model;
}

// The balls end up a millimetre and some centimetres lower, one on another: they may lie close, but not in
// each other.
std::vector<double> fall_on_one_another(const world::EngineSetting& engine) {
  Lab lab(cube_of_balls(engine, kMarble + 1e-3, 0.0));
  const double energy = energy_of(lab.model, lab.state);
  double depth = 0.0, gained = 0.0;
  watch(lab, 0.5, [&] {
    depth = std::max(depth, deepest(lab.contacts));
    gained = std::max(gained, energy_of(lab.model, lab.state) / energy - 1.0);
  });
  return {depth, deepest(lab.contacts), gained};
}

std::vector<double> bounce_through_one_another(const world::EngineSetting& engine) {
  Lab lab(cube_of_balls(engine, kMarble + 1.001, 1.0));
  const double energy = energy_of(lab.model, lab.state);
  double change = 0.0;
  watch(lab, 1.0,
        [&] { change = std::max(change, std::abs(energy_of(lab.model, lab.state) / energy - 1.0)); });
  return {change};
}

// SimBenchmark's "rolling": 25 balls of 1 kg on a plate of 10 kg that slides on the ground.
world::WorldModel plate_with_balls(const world::EngineSetting& engine) {
  constexpr double kThickness = 0.1, kPitch = 0.4;
  ModelBuilder b(engine);
  // The geometric mean of two surfaces counts: 0.4 under the plate, 0.8 on it.
  const auto under = b.add_surface(0.2, 0.0), plate = b.add_surface(0.8, 0.0);
  b.add_ground(under);
  b.add_box("plate", {2.5, 2.5, kThickness}, 10.0, at(0, 0, 0.5 * kThickness - kTouch), plate);
  for (int i = 0; i < 25; ++i)
    b.add_sphere("ball_" + std::to_string(i), kMarble, 1.0,
                 at(kPitch * (i % 5 - 2), kPitch * (i / 5 - 2), kThickness + kMarble - 2.0 * kTouch), plate);
  return b.model;
}

// The plate accelerates with A, the balls with 2 A / 7: they roll backwards on it, f = 2 m A / 7 each.
std::vector<double> roll_on_a_plate(const world::EngineSetting& engine) {
  constexpr double kForceN = 150.0, kPlateKg = 10.0, kBallsKg = 25.0, kSeconds = 1.0;
  Lab lab(plate_with_balls(engine));
  const Vector3d along = Vector3d(1.0, 1.0, 0.0).normalized();
  lab.wrenches.push_back({lab.model.find_body("plate"), kForceN * along, Vector3d::Zero()});
  lab.run(kSeconds);
  const double speed =
      (kForceN - 0.4 * (kPlateKg + kBallsKg) * kG) / (kPlateKg + 2.0 / 7.0 * kBallsKg) * kSeconds;
  double ball = 0.0;
  for (int i = 0; i < 25; ++i)
    ball = std::max(ball, (lab.body("ball_" + std::to_string(i)).v_WC - 2.0 / 7.0 * speed * along).norm());
  return {(lab.body("plate").v_WC - speed * along).norm(), ball};
}

}  // namespace

std::vector<Case> crowd_cases() {
  return {
      {"K9",
       "BallsFallOnOneAnother",
       "SimBenchmark's 666; closed form: no depth but what carries, no energy gained",
       {{"depth_m", 1e-3}, {"rest_depth_m", 1e-4}, {"gain", 1e-9}},
       fall_on_one_another},
      {"K9e",
       "ElasticBallsKeepTheirEnergy",
       "SimBenchmark's 666, elastic; closed form: E constant",
       {{"energy", 1e-3}},
       bounce_through_one_another},
      {"K10",
       "BallsRollOnASlidingPlate",
       "SimBenchmark's rolling; closed form: v = (F - 0.4 (M + 25 m) g) / (M + 50 m / 7) t, balls 2 v / 7",
       {{"plate_m_per_s", 1e-3}, {"balls_m_per_s", 1e-3}},
       roll_on_a_plate},
  };
}

}  // namespace visum::physics
