#include "server/cycle/pull.h"

#include <algorithm>

namespace visum::cycle {
namespace {

constexpr double kFrequency = 20.0;  // rad/s
constexpr double kMostPerTick = 0.25;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return matrix;
}

}  // namespace

// With K the acceleration of the point per force, M = K^-1 its mass as a force feels it, d the way to the
// target, v the point's velocity, w the frequency and h the tick:
//     F = M (w^2 d⁺ - 2 w v⁺) at the tick's end, where v⁺ = v + h F/M and d⁺ = d - h v⁺
//  => F = M (w^2 (d - h v) - 2 w v) / (1 + 2 w h + w^2 h^2)
dynamics::Wrench wrench_of(const Pull& pull, const world::WorldModel& model, const world::WorldState& state,
                           double tick_s) {
  const world::Body& body = model.bodies[pull.body.index()];
  const world::BodyState& motion = state.bodies[pull.body.index()];
  const Eigen::Vector3d r = motion.q_WB * (pull.p_B - body.p_BC);
  const Eigen::Vector3d way = pull.target_W - (motion.p_WC + r);
  const Eigen::Vector3d speed = motion.v_WC + motion.w_WB.cross(r);
  const Eigen::Matrix3d R = motion.q_WB.toRotationMatrix(), arm = cross_matrix(r);
  const Eigen::Matrix3d response =
      Eigen::Matrix3d::Identity() / body.mass_kg - arm * (R * body.inertia_C.inverse() * R.transpose()) * arm;
  const double w = std::min(kFrequency, kMostPerTick / tick_s), wh = w * tick_s;
  Eigen::Vector3d force =
      response.inverse() * (w * w * (way - tick_s * speed) - 2.0 * w * speed) / (1.0 + 2.0 * wh + wh * wh);
  const double size = force.norm();
  if (size > pull.max_force_n) force *= pull.max_force_n / size;
  return {pull.body, force, r.cross(force)};
}

}  // namespace visum::cycle
