#include "tests/dynamics/physics/serial_models.h"

#include <cmath>
#include <numbers>
#include <string>

namespace visum::physics {
namespace {

using Eigen::Vector3d;

world::Body body_of(const Link& link, std::size_t index, const Vector3d& p_WB) {
  world::Body body;
  body.name = "link_" + std::to_string(index);
  body.mass_kg = link.mass_kg;
  body.p_BC = link.p_com;
  body.inertia_C = link.inertia.asDiagonal();
  body.X_WB.p = p_WB;
  return body;
}

world::Joint joint_of(const Link& link, std::int32_t index) {
  world::Joint joint;
  joint.name = "joint_" + std::to_string(index);
  joint.parent = {index - 1};
  joint.child = {index};
  joint.X_PJ.p = link.p_joint;
  joint.axis_J = link.axis;
  joint.initial_position = link.q0;
  return joint;
}

Link cylinder_link(const Vector3d& p_joint, const Vector3d& axis, double mass_kg, double z_com, double radius,
                   double length, double q0) {
  return {p_joint, axis, mass_kg, {0.0, 0.0, z_com}, solid_cylinder_inertia(mass_kg, radius, length), q0};
}

Link pendulum(double mass_kg, double z_com, const Vector3d& inertia, double angle) {
  return {Vector3d::Zero(), Vector3d::UnitY(), mass_kg, {0.0, 0.0, z_com}, inertia, angle};
}

}  // namespace

world::WorldModel serial_model(const world::EngineSetting& engine, double tick_s,
                               const std::vector<Link>& links) {
  world::WorldModel model;
  model.tick_ns = std::llround(1e9 * tick_s);
  model.engines.push_back(engine);
  model.surfaces.push_back({"default"});
  Vector3d p_WB = Vector3d::Zero();
  for (std::size_t i = 0; i < links.size(); ++i) {
    p_WB += links[i].p_joint;
    model.bodies.push_back(body_of(links[i], i, p_WB));
    model.joints.push_back(joint_of(links[i], static_cast<std::int32_t>(i)));
  }
  return model;
}

Vector3d solid_cylinder_inertia(double mass_kg, double radius, double length) {
  const double across = mass_kg * (3.0 * radius * radius + length * length) / 12.0;
  return {across, across, 0.5 * mass_kg * radius * radius};
}

world::WorldModel arm7(const world::EngineSetting& engine, double tick_s) {
  constexpr double kMasses[] = {4.0, 4.0, 3.5, 3.0, 2.5, 2.0, 2.0};
  constexpr double kStart[] = {0.3, 0.8, -0.4, 1.0, 0.5, -0.7, 0.2};
  std::vector<Link> links;
  for (int i = 0; i < 7; ++i)
    links.push_back(cylinder_link({0.0, 0.0, i == 0 ? 0.1 : 0.3},
                                  i % 2 == 0 ? Vector3d::UnitZ() : Vector3d::UnitY(), kMasses[i], 0.15, 0.05,
                                  0.3, kStart[i]));
  return serial_model(engine, tick_s, links);
}

const std::vector<TipAt>& arm7_tips() {
  static const std::vector<TipAt> tips{{0.25, {1.503285794616, 0.008598987261, 0.727025692864}},
                                       {0.5, {1.388280117269, 0.046977667418, -0.428352786669}},
                                       {1.0, {-1.195491236204, -0.280135434506, 0.509956661895}},
                                       {2.0, {0.636457919643, -0.063979459897, -0.863233000766}}};
  return tips;
}

world::WorldModel chain(const world::EngineSetting& engine, double tick_s, int count) {
  std::vector<Link> links;
  for (int i = 0; i < count; ++i)
    links.push_back(cylinder_link({0.0, 0.0, i == 0 ? 0.0 : -0.1},
                                  i % 2 == 0 ? Vector3d::UnitY() : Vector3d::UnitX(), 0.2, -0.05, 0.02, 0.1,
                                  i == 0 ? 0.5 : 0.01 * (i % 5 - 2)));
  return serial_model(engine, tick_s, links);
}

world::WorldModel double_pendulum(const world::EngineSetting& engine, double tick_s) {
  const Vector3d inertia{1.0 / 12.0, 1.0 / 12.0, 5e-5};
  Link upper = pendulum(1.0, -0.5, inertia, 0.5 * std::numbers::pi);
  Link lower = pendulum(1.0, -0.5, inertia, 0.0);
  lower.p_joint = {0.0, 0.0, -1.0};
  return serial_model(engine, tick_s, {upper, lower});
}

const std::vector<TipAt>& double_pendulum_tips() {
  static const std::vector<TipAt> tips{{1.0, {1.662115135816, 0.0, -1.041466637193}},
                                       {2.0, {-0.313524776450, 0.0, -1.914746617562}},
                                       {5.0, {-1.855221937758, 0.0, -0.739567932547}},
                                       {10.0, {1.655867424177, 0.0, -0.528445481016}}};
  return tips;
}

world::WorldModel metre_pendulum(const world::EngineSetting& engine, double tick_s, double angle) {
  return serial_model(engine, tick_s, {pendulum(1.0, -0.5, Vector3d::Constant(0.25), angle)});
}

world::WorldModel rod_pendulum(const world::EngineSetting& engine, double tick_s, double angle) {
  return serial_model(engine, tick_s, {pendulum(1.0, -0.5, {1.0 / 12.0, 1.0 / 12.0, 5e-5}, angle)});
}

}  // namespace visum::physics
