// K1, K2, K3, K6, K7, K8: friction, rolling, standing.
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

// A flat box on the plane; gravity is tilted instead of the plane.
world::WorldModel box_on_slope(const world::EngineSetting& engine, double slope, double friction) {
  ModelBuilder b(engine);
  const auto surface = b.add_surface(friction, 0.0);
  b.add_ground(surface);
  b.add_box("box", {0.2, 0.2, 0.1}, 1.0, at(0, 0, 0.05 - kTouch), surface);
  b.model.gravity = kG * Vector3d(std::sin(slope), 0.0, -std::cos(slope));
  return b.model;
}

std::vector<double> slide_down(const world::EngineSetting& engine) {
  Lab lab(box_on_slope(engine, 30.0 * kDegree, 0.3));
  lab.run(2.0);
  return {std::abs(lab.body("box").p_WC.x() / 4.712575 - 1.0)};
}

std::vector<double> stick(const world::EngineSetting& engine) {
  Lab lab(box_on_slope(engine, 20.0 * kDegree, 0.5));
  lab.run(1.0);
  const Vector3d before = lab.body("box").p_WC;
  lab.run(1.0);
  return {(lab.body("box").p_WC - before).norm()};
}

double stop_distance(const world::EngineSetting& engine, double direction) {
  auto model = box_on_slope(engine, 0.0, 0.3);
  model.bodies.back().v_WB = 2.0 * Vector3d(std::cos(direction), std::sin(direction), 0.0);
  Lab lab(std::move(model));
  lab.run(1.0);
  return lab.body("box").p_WC.head<2>().norm();
}

std::vector<double> slide_diagonally(const world::EngineSetting& engine) {
  const double axial = stop_distance(engine, 0.0), diagonal = stop_distance(engine, 45.0 * kDegree);
  return {std::abs(axial / 0.679579 - 1.0), std::abs(diagonal / axial - 1.0)};
}

std::vector<double> slide_then_roll(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  const auto surface = b.add_surface(0.3, 0.0);
  b.add_ground(surface);
  b.body(b.add_sphere("ball", 0.1, 1.0, at(0, 0, 0.1 - kTouch), surface)).v_WB = {2.0, 0.0, 0.0};
  Lab lab(b.model);
  lab.run(1.0);
  return {std::abs(lab.body("ball").v_WC.x() / (2.0 * 5.0 / 7.0) - 1.0)};
}

// The motion once the first touch is over.
std::vector<double> stand(world::WorldModel model, double seconds) {
  Lab lab(std::move(model));
  lab.run(0.2);
  const auto start = lab.state;
  lab.run(seconds);
  double sideways = 0.0, down = 0.0;
  for (std::size_t i = 0; i < start.bodies.size(); ++i) {
    const Vector3d moved = lab.state.bodies[i].p_WC - start.bodies[i].p_WC;
    sideways = std::max(sideways, moved.head<2>().norm());
    down = std::max(down, std::abs(moved.z()));
  }
  return {sideways, down};
}

std::vector<double> stand_ten(const world::EngineSetting& engine) {
  return stand(stack(engine, 1e-3, 10), 2.0);
}

std::vector<double> stand_twenty(const world::EngineSetting& engine) {
  return stand(stack(engine, 1e-3, 20), 0.3);
}

std::vector<double> stand_ten_long(const world::EngineSetting& engine) {
  return stand(stack(engine, 1e-3, 10), 60.0);
}

std::vector<double> stand_under_load(const world::EngineSetting& engine) {
  return stand(stack(engine, 1e-3, 2, 100.0), 2.0);
}

}  // namespace

std::vector<Case> sliding_cases() {
  return {
      {"K1",
       "BoxSlidesDown30Degrees",
       "closed form: s = g (sin 30° - 0.3 cos 30°) t² / 2",
       {{"way", 1e-5}},
       slide_down},
      {"K2",
       "BoxSticksAt20Degrees",
       "closed form: tan 20° < 0.5: no motion",
       {{"creep_m_per_s", 1e-10}},
       stick},
      {"K3",
       "SlideIsTheSameInEveryDirection",
       "closed form: v² / (2 μ g), any direction",
       {{"stop", 2e-3}, {"isotropy", 2e-3}},
       slide_diagonally},
      {"K6", "BallSlidesThenRolls", "closed form: 5 v / 7", {{"speed", 1e-4}}, slide_then_roll},
      {"K7",
       "StackOf10Stands",
       "closed form: no motion",
       {{"sideways_m", 1e-6}, {"down_m", 1e-6}},
       stand_ten},
      {"K7t",
       "StackOf20Stands",
       "closed form: no motion",
       {{"sideways_m", 1e-6}, {"down_m", 1e-6}},
       stand_twenty},
      {"K7l",
       "StackOf10StandsForAMinute",
       "closed form: no motion",
       {{"sideways_m", 1e-6}, {"down_m", 1e-6}},
       stand_ten_long,
       true},
      {"K8",
       "OneKiloCarries100",
       "closed form: no motion",
       {{"sideways_m", 1e-6}, {"down_m", 1e-6}},
       stand_under_load},
  };
}

}  // namespace visum::physics
