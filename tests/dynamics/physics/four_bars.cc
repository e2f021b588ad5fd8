#include <cmath>
#include <string>

#include "tests/dynamics/physics/loop_models.h"

namespace visum::physics {
namespace {

using Eigen::Vector3d;

constexpr double kAlong = 5e-5;  // of a thin rod's inertia, about its axis
constexpr double kAcross = 1.0 / 12.0;

// A rod of 1 m and 1 kg from its frame's origin along `axis`.
world::Body rod(const std::string& name, const Vector3d& axis, const Vector3d& p_WB) {
  world::Body body;
  body.name = name;
  body.mass_kg = 1.0;
  body.p_BC = 0.5 * axis;
  body.inertia_C = (kAcross * (Vector3d::Ones() - axis) + kAlong * axis).asDiagonal();
  body.X_WB.p = p_WB;
  return body;
}

world::Joint hinge(const std::string& name, std::size_t parent, const Vector3d& p_parent, std::size_t child,
                   const Vector3d& p_child) {
  world::Joint joint;
  joint.name = name;
  joint.parent = {static_cast<std::int32_t>(parent)};
  joint.child = {static_cast<std::int32_t>(child)};
  joint.X_PJ.p = p_parent;
  joint.X_CJ.p = p_child;
  joint.axis_J = Vector3d::UnitY();
  return joint;
}

void add_upright(world::WorldModel& model, int index) {
  const std::string number = std::to_string(index);
  world::Body body = rod("rod_" + number, Vector3d::UnitZ(), {static_cast<double>(index), 0.0, 0.0});
  body.w_WB = Vector3d::UnitY();
  model.joints.push_back(hinge("ground_" + number, 0, body.X_WB.p, model.bodies.size(), Vector3d::Zero()));
  model.joints.back().parent = {};
  model.bodies.push_back(body);
}

// From the top of the rod before, to the top of the rod that was added last.
void add_coupler(world::WorldModel& model, int index, std::size_t from, std::size_t to) {
  const std::string number = std::to_string(index);
  world::Body body = rod("coupler_" + number, Vector3d::UnitX(), {static_cast<double>(index), 0.0, 1.0});
  body.v_WB = Vector3d::UnitX();
  const std::size_t coupler = model.bodies.size();
  model.joints.push_back(hinge("carry_" + number, from, Vector3d::UnitZ(), coupler, Vector3d::Zero()));
  model.joints.push_back(hinge("close_" + number, to, Vector3d::UnitZ(), coupler, Vector3d::UnitX()));
  model.bodies.push_back(body);
}

}  // namespace

world::WorldModel four_bars(const world::EngineSetting& engine, double tick_s, int loops) {
  world::WorldModel model;
  model.tick_ns = std::llround(1e9 * tick_s);
  model.engines.push_back(engine);
  model.surfaces.push_back({"default"});
  add_upright(model, 0);
  std::size_t last = 0;
  for (int i = 0; i < loops; ++i) {
    add_upright(model, i + 1);
    const std::size_t next = model.bodies.size() - 1;
    add_coupler(model, i, last, next);
    last = next;
  }
  return model;
}

const std::vector<TipAt>& four_bars_tips() {
  static const std::vector<TipAt> tips{{1.0, {-0.195020301949, 0.0, -0.980799205662}},
                                       {2.0, {0.057815795768, 0.0, 0.998327267863}},
                                       {5.0, {-0.811310461005, 0.0, -0.584615545349}},
                                       {10.0, {0.328458111541, 0.0, 0.944518538179}}};
  return tips;
}

// The one equation by RK4 in steps of 0.1 ms: right to 1e-12 after 10 s.
Vector3d four_bars_tip(int loops, double time_s) {
  constexpr double kStep = 1e-4;
  const double load = 9.81 * (0.5 * (loops + 1) + loops) / ((loops + 1) / 3.0 + loops);
  const auto f = [&](double angle) { return load * std::sin(angle); };
  double q = 0.0, w = 1.0;
  for (long i = std::lround(time_s / kStep); i > 0; --i) {
    const double w1 = w, a1 = f(q);
    const double w2 = w + 0.5 * kStep * a1, a2 = f(q + 0.5 * kStep * w1);
    const double w3 = w + 0.5 * kStep * a2, a3 = f(q + 0.5 * kStep * w2);
    const double w4 = w + kStep * a3, a4 = f(q + kStep * w3);
    q += kStep / 6.0 * (w1 + 2.0 * w2 + 2.0 * w3 + w4);
    w += kStep / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  return {std::sin(q), 0.0, std::cos(q)};
}

}  // namespace visum::physics
