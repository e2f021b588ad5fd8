// F: bodies that nothing holds.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

using Eigen::Vector3d;

// The box of S. Peters' benchmark of rigid bodies (scpeters/benchmark): 0.1 x 0.4 x 0.9 m, 10 kg.
world::WorldModel tossed_box(const world::EngineSetting& engine, double tick_s, const Vector3d& v,
                             const Vector3d& w, double g) {
  auto model = serial_model(engine, tick_s,
                            {{Vector3d::Zero(),
                              Vector3d::UnitZ(),
                              10.0,
                              Vector3d::Zero(),
                              {0.80833333, 0.68333333, 0.14166667},
                              0.0}});
  model.joints.clear();
  model.gravity = {0.0, 0.0, -g};
  model.bodies[0].v_WB = v;
  model.bodies[0].w_WB = w;
  return model;
}

struct Toss {
  double momentum = 0.0;  // largest relative change of the angular momentum
  double energy = 0.0;    // relative
  double com_m = 0.0;     // off the parabola, at the end
  Eigen::Matrix3d R;      // at the end
};

Toss toss(world::WorldModel model) {
  Lab lab(std::move(model));
  const auto& motion = lab.state.bodies[0];
  const Vector3d spin = spin_of(lab.model.bodies[0], motion), v = motion.v_WC;
  const double energy = energy_of(lab.model, lab.state);
  Toss result;
  watch(lab, 10.0, [&] {
    const Vector3d change = spin_of(lab.model.bodies[0], motion) - spin;
    result.momentum = std::max(result.momentum, change.norm() / spin.norm());
    result.energy = std::max(result.energy, std::abs(energy_of(lab.model, lab.state) - energy) / energy);
  });
  result.com_m = (motion.p_WC - (10.0 * v + 50.0 * lab.model.gravity)).norm();
  result.R = motion.q_WB.toRotationMatrix();
  return result;
}

std::vector<double> simple_toss(const world::EngineSetting& engine) {
  const Toss result = toss(tossed_box(engine, 1e-3, {-0.9, 0.4, 0.1}, {0.5, 0.0, 0.0}, 0.0));
  return {result.momentum, result.energy, result.com_m};
}

world::WorldModel tumbling(const world::EngineSetting& engine, double tick_s) {
  return tossed_box(engine, tick_s, {-2.0, 2.0, 8.0}, {0.1, 5.0, 0.1}, 9.8);
}

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

// Integrated by DOP853 to 1e-12.
const Eigen::Matrix3d& tumbled() {
  static const Eigen::Matrix3d R{{-0.129981473272, 0.028810460652, -0.991097762061},
                                 {0.658141563855, -0.745111538104, -0.107974430816},
                                 {-0.741589170992, -0.666317306650, 0.077889333846}};
  return R;
}

std::vector<double> tumble(const world::EngineSetting& engine) {
  const Toss result = toss(tumbling(engine, 1e-3));
  return {result.momentum, result.energy, result.com_m, angle_between(tumbled(), result.R)};
}

std::vector<double> tumble_coarsely(const world::EngineSetting& engine) {
  const Toss result = toss(tumbling(engine, 1e-2));
  return {result.momentum, result.com_m};
}

// Seven links in space, straight, each joint turning at a rate of its own.
world::WorldModel floating_chain(const world::EngineSetting& engine) {
  constexpr double kRates[] = {0.0, 0.7, -1.1, 0.4, 1.3, -0.6, 0.9};
  auto model = arm7(engine, 1e-3);
  model.gravity.setZero();
  model.bodies[0].v_WB = {0.1, -0.2, 0.3};
  model.bodies[0].w_WB = {0.3, 0.2, -0.1};
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const auto& joint = model.joints[i];
    const auto& before = model.bodies[i - 1];
    model.bodies[i].v_WB = before.v_WB + before.w_WB.cross(joint.X_PJ.p);
    model.bodies[i].w_WB = before.w_WB + kRates[i] * joint.axis_J;
  }
  for (auto& joint : model.joints) joint.initial_position = 0.0;
  model.joints.erase(model.joints.begin());
  return model;
}

std::vector<double> keep_momentum(const world::EngineSetting& engine) {
  Lab lab(floating_chain(engine));
  MomentumDrift drift(lab.model, lab.state);
  watch(lab, 2.0, [&] { drift.look(lab.model, lab.state); });
  return {drift.linear, drift.angular};
}

}  // namespace

std::vector<Case> free_cases() {
  return {
      {"F1",
       "FreeBoxSlidesAndSpins",
       "closed form: x = v t, L and E constant",
       {{"momentum", 1e-13}, {"energy", 1e-12}, {"com_m", 1e-11}},
       simple_toss},
      {"F2",
       "FreeBoxTumbles",
       "closed form: parabola, L and E constant; orientation after 10 s by DOP853 at 1e-12 (scpeters' "
       "complex box)",
       {{"momentum", 1e-13}, {"energy", 1e-5}, {"com_m", 1e-9}, {"orientation_rad", 1e-3}},
       tumble},
      {"F2c",
       "FreeBoxTumblesIn10msSteps",
       "closed form: parabola, L constant",
       {{"momentum", 1e-13}, {"com_m", 1e-9}},
       tumble_coarsely},
      {"F3",
       "FloatingChainKeepsItsMomentum",
       "closed form: P and L constant",
       {{"momentum", 1e-12}, {"angular_momentum", 1e-12}},
       keep_momentum},
  };
}

}  // namespace visum::physics
