#include "tests/dynamics/physics/free_models.h"

#include <algorithm>
#include <cmath>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {

using Eigen::Vector3d;

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

world::WorldModel tumbling_box(const world::EngineSetting& engine, double tick_s) {
  return tossed_box(engine, tick_s, {-2.0, 2.0, 8.0}, {0.1, 5.0, 0.1}, 9.8);
}

const Eigen::Matrix3d& tumbled() {
  static const Eigen::Matrix3d R{{-0.129981473272, 0.028810460652, -0.991097762061},
                                 {0.658141563855, -0.745111538104, -0.107974430816},
                                 {-0.741589170992, -0.666317306650, 0.077889333846}};
  return R;
}

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

namespace {

double energy_of_one(const world::WorldModel& model, std::size_t i, const world::BodyState& motion) {
  const world::Body& body = model.bodies[i];
  return 0.5 * body.mass_kg * motion.v_WC.squaredNorm() + 0.5 * motion.w_WB.dot(spin_of(body, motion)) -
         body.mass_kg * model.gravity.dot(motion.p_WC);
}

}  // namespace

std::vector<Toss> toss(world::WorldModel model) {
  constexpr double kSeconds = 10.0;
  Lab lab(std::move(model));
  const std::vector<world::BodyState> start = lab.state.bodies;
  std::vector<Toss> tosses(start.size());
  watch(lab, kSeconds, [&] {
    for (std::size_t i = 0; i < tosses.size(); ++i) {
      const auto& motion = lab.state.bodies[i];
      const Vector3d spin = spin_of(lab.model.bodies[i], start[i]);
      const Vector3d change = spin_of(lab.model.bodies[i], motion) - spin;
      const double energy = energy_of_one(lab.model, i, start[i]);
      tosses[i].momentum = std::max(tosses[i].momentum, change.norm() / spin.norm());
      tosses[i].energy =
          std::max(tosses[i].energy, std::abs(energy_of_one(lab.model, i, motion) / energy - 1.0));
    }
  });
  for (std::size_t i = 0; i < tosses.size(); ++i) {
    const auto& motion = lab.state.bodies[i];
    const Vector3d fallen = 0.5 * kSeconds * kSeconds * lab.model.gravity;
    tosses[i].com_m = (motion.p_WC - start[i].p_WC - kSeconds * start[i].v_WC - fallen).norm();
    tosses[i].R = motion.q_WB.toRotationMatrix();
  }
  return tosses;
}

}  // namespace visum::physics
