// P1, P2, P3, F4: one and two rods, and the top.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

using Eigen::Vector3d;
constexpr double kGravity = 9.81;

std::vector<double> swing_from_level(const world::EngineSetting& engine) {
  struct {
    double time_s, angle;
  } constexpr kAngles[] = {
      {1.0, -1.4050273115248}, {2.0, 0.91664758966324}, {5.0, 1.2294518114854}, {10.0, 0.27868067356998}};
  Lab lab(metre_pendulum(engine, 1e-3, 90.0 * kDegree));
  std::vector<double> errors;
  double before = 0.0;
  for (const auto& [time_s, angle] : kAngles) {
    lab.run(time_s - before);
    before = time_s;
    errors.push_back(std::abs(lab.joint("joint_0").position - angle));
  }
  return errors;
}

// From rest at one end to rest at the other, twice. Between the ticks in which the velocity changes its sign,
// the velocity counts as straight.
double period(world::WorldModel model) {
  Lab lab(std::move(model));
  const double tick = lab.tick_s();
  double before = 0.0;
  for (int i = 1; i < 10'000; ++i) {
    lab.run_ticks(1);
    const double velocity = lab.joint("joint_0").velocity;
    if (before < 0.0 && velocity >= 0.0) return 2.0 * tick * (i - velocity / (velocity - before));
    before = velocity;
  }
  throw std::runtime_error("the pendulum does not come back");
}

std::vector<double> period_by_amplitude(const world::EngineSetting& engine) {
  struct {
    double degrees, ratio;
  } constexpr kPeriods[] = {{10.0, 1.001907188}, {30.0, 1.017408798},  {60.0, 1.073182007},
                            {90.0, 1.180340599}, {120.0, 1.372880501}, {150.0, 1.76220373},
                            {170.0, 2.43936272}};
  const double small = 2.0 * std::numbers::pi * std::sqrt(1.0 / kGravity);
  double worst = 0.0;
  for (const auto& [degrees, ratio] : kPeriods)
    worst = std::max(
        worst, std::abs(period(metre_pendulum(engine, 1e-3, degrees * kDegree)) / (ratio * small) - 1.0));
  return {worst};
}

std::vector<double> rod_period(const world::EngineSetting& engine) {
  const double small = 2.0 * std::numbers::pi * std::sqrt(2.0 / 3.0 / kGravity);
  return {std::abs(period(rod_pendulum(engine, 1e-3, 90.0 * kDegree)) / (1.180340599 * small) - 1.0)};
}

std::vector<double> double_swing(const world::EngineSetting& engine) {
  Lab lab(double_pendulum(engine, 1e-3));
  const double energy = energy_of(lab.model, lab.state), scale = energy_scale(lab.model);
  std::vector<double> figures;
  double drift = 0.0, gap = 0.0, before = 0.0;
  for (const TipAt& tip : double_pendulum_tips()) {
    watch(lab, tip.time_s - before, [&] {
      drift = std::max(drift, std::abs(energy_of(lab.model, lab.state) - energy) / scale);
      gap = std::max(gap, max_gap(lab.model, lab.state));
    });
    before = tip.time_s;
    figures.push_back((point_of(lab.model, lab.state, {1}, kDoublePendulumTip) - tip.p_W).norm());
  }
  figures.push_back(drift);
  figures.push_back(gap);
  return figures;
}

// A heavy symmetric top on its tip: 1 kg, centre of mass 0.1 m up its axis, 30° off the vertical.
constexpr double kLean = 30.0 * kDegree, kReach = 0.1, kAxial = 0.003, kAcross = 0.002, kSpin = 130.0;

double steady_precession() {
  const double a = kAcross + kReach * kReach, load = kGravity * kReach, c = kAxial * kSpin;
  return (c - std::sqrt(c * c - 4.0 * a * load * std::cos(kLean))) / (2.0 * a * std::cos(kLean));
}

world::WorldModel top(const world::EngineSetting& engine) {
  auto model = serial_model(
      engine, 1e-3,
      {{Vector3d::Zero(), Vector3d::UnitZ(), 1.0, {0.0, 0.0, kReach}, {kAcross, kAcross, kAxial}, 0.0}});
  model.joints[0].kind = world::JointKind::kBall;
  auto& body = model.bodies[0];
  body.X_WB.q = Eigen::AngleAxisd(kLean, Vector3d::UnitY());
  model.joints[0].X_CJ.q = body.X_WB.q.conjugate();
  const Vector3d axis = body.X_WB.q * Vector3d::UnitZ();
  const double rate = steady_precession();
  body.w_WB = rate * Vector3d::UnitZ() + (kSpin - rate * std::cos(kLean)) * axis;
  return model;
}

std::vector<double> precess(const world::EngineSetting& engine) {
  Lab lab(top(engine));
  const auto axis = [&] { return Vector3d(lab.state.bodies[0].q_WB * Vector3d::UnitZ()); };
  double nutation = 0.0;
  watch(lab, 1.0, [&] { nutation = std::max(nutation, std::abs(std::acos(axis().z()) - kLean)); });
  const double angle = std::atan2(axis().y(), axis().x());
  return {std::abs(std::remainder(angle - steady_precession(), 2.0 * std::numbers::pi)), nutation};
}

}  // namespace

std::vector<Case> pendulum_cases() {
  return {
      {"F4",
       "TopPrecessesSteadily",
       "closed form: Ω = (C n - sqrt(C² n² - 4 A m g l cos θ)) / (2 A cos θ), no nutation",
       {{"precession_rad", 1e-3}, {"nutation_rad", 1e-3}},
       precess},
      {"P1",
       "PendulumSwingsFromLevel",
       "IFToMM A01: elliptic integrals, equivalent length 1 m",
       {{"angle_1s_rad", 1e-5}, {"angle_2s_rad", 1e-5}, {"angle_5s_rad", 1e-4}, {"angle_10s_rad", 1e-4}},
       swing_from_level},
      {"P1p",
       "PendulumsPeriodGrowsWithItsAmplitude",
       "closed form: T/T0 = 2 K(sin(a/2)) / pi, 10° to 170°",
       {{"period", 1e-5}},
       period_by_amplitude},
      {"P2",
       "RodsPeriodIsThatOfTwoThirdsOfItsLength",
       "closed form: equivalent length 2 l / 3",
       {{"period", 1e-5}},
       rod_period},
      {"P3",
       "DoublePendulumKeepsItsEnergy",
       "Gragg-Bulirsch-Stoer in long double, two step sizes agree to 1e-11",
       {{"tip_1s_m", 1e-4},
        {"tip_2s_m", 1e-4},
        {"tip_5s_m", 1e-2},
        {"tip_10s_m", 0.1},
        {"energy", 7e-5, 4e-9, 1e-11},
        gap_figure("gap_m")},
       double_swing},
  };
}

}  // namespace visum::physics
