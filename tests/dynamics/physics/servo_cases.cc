// S: drives at joints.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dynamics/physics/case.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;

// A wheel of 1 kg·m² on a hinge, no gravity.
world::WorldModel wheel(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  b.model.gravity.setZero();
  const auto id = b.add_rotor("wheel", 1.0, 1.0, at(0, 0, 0));
  b.add_joint("axle", world::JointKind::kHinge, {}, id, {0, 0, 0}, Vector3d::UnitZ());
  return b.model;
}

// 0 to 1 rad/s at 2 N·m: half a second of ramp, then constant speed.
std::vector<double> reach_speed(const world::EngineSetting& engine) {
  Lab lab(wheel(engine));
  lab.drive("axle") = {1.0, 0.0, 2.0, 0.0};
  double torque = 0.0, speed = 0.0;
  watch(lab, 1.0, [&] {
    torque = std::max(torque, std::abs(lab.joint("axle").effort));
    speed = std::max(speed, lab.joint("axle").velocity);
  });
  // Time is counted in ticks: a ramp made of constant torques cannot be more accurate than half a tick.
  return {std::abs(lab.joint("axle").position - 0.75), std::max(0.0, speed - 1.0),
          std::max(0.0, torque - 2.0), std::abs(lab.joint("axle").effort)};
}

// A quarter turn by a profile of speed: as much as the cap on the torque allows, 1 rad/s, and down again so
// late that the cap just stops it at the end. Between two ticks the wheel's speed changes evenly.
struct Trapezoid {
  static constexpr double kEnd = 0.5 * std::numbers::pi, kFastest = 1.0, kMost = 2.0;    // rad, rad/s, N·m
  static constexpr double kRamp = kFastest / kMost, kArrives = kEnd / kFastest + kRamp;  // s

  // As fast as the rest of the way can be braked, and not past the end within a tick of length h.
  static double speed(double angle, double h) {
    const double left = kEnd - angle, away = std::abs(left);
    return std::copysign(std::min({kFastest, std::sqrt(2.0 * kMost * away), away / h}), left);
  }
  static double angle(double t) {
    if (t < kRamp) return 0.5 * kMost * t * t;
    if (t < kArrives - kRamp) return 0.5 * kFastest * kRamp + kFastest * (t - kRamp);
    const double left = std::max(0.0, kArrives - t);
    return kEnd - 0.5 * kMost * left * left;
  }
};

std::vector<double> turn_a_quarter(const world::EngineSetting& engine) {
  Lab lab(wheel(engine));
  const auto& axle = lab.joint("axle");
  double over = 0.0, fast = 0.0, torque = 0.0, place = 0.0;
  for (int i = 0; i < 3000; ++i) {
    lab.drive("axle") = {Trapezoid::speed(axle.position, lab.tick_s()), 0.0, Trapezoid::kMost, 0.0};
    lab.run_ticks(1);
    const double t = lab.tick_s() * static_cast<double>(lab.state.tick);
    over = std::max(over, (axle.position - Trapezoid::kEnd) / kDegree);
    fast = std::max(fast, axle.velocity - Trapezoid::kFastest);
    torque = std::max(torque, std::abs(axle.effort) - Trapezoid::kMost);
    place = std::max(place, std::abs(axle.position - Trapezoid::angle(t)));
  }
  return {std::max(0.0, over), std::max(0.0, fast), std::max(0.0, torque), place,
          std::abs(axle.position - Trapezoid::kEnd)};
}

std::vector<double> saturate(const world::EngineSetting& engine) {
  Lab lab(wheel(engine));
  lab.drive("axle") = {1000.0, 0.0, 1.0, 0.0};
  double torque = 0.0;
  watch(lab, 1.0, [&] { torque = std::max(torque, std::abs(lab.joint("axle").effort - 1.0)); });
  return {std::abs(lab.joint("axle").velocity - 1.0), std::abs(lab.joint("axle").position - 0.5), torque};
}

// A servo holds a loaded arm level: its torque equals the load's, and the arm does not sink.
std::vector<double> hold_load(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  const auto id = b.add_rotor("arm", 2.0, 0.1, at(0.5, 0, 0));
  b.add_joint("elbow", world::JointKind::kHinge, {}, id, {0, 0, 0}, Vector3d::UnitY());
  Lab lab(b.model);
  lab.drive("elbow") = {0.0, 0.0, 50.0, 0.0};
  lab.run(1.0);
  return {std::abs(lab.joint("elbow").position), std::abs(lab.joint("elbow").effort + 2.0 * 9.81 * 0.5)};
}

std::vector<double> run_into_stop(const world::EngineSetting& engine) {
  auto model = wheel(engine);
  model.joints[0].limited = true;
  model.joints[0].lower = -1.0;
  model.joints[0].upper = 0.5;
  Lab lab(std::move(model));
  lab.drive("axle") = {0.0, 0.0, 0.0, 3.0};
  double beyond = 0.0;
  watch(lab, 2.0, [&] { beyond = std::max(beyond, lab.joint("axle").position - 0.5); });
  return {beyond, std::abs(lab.joint("axle").velocity)};
}

}  // namespace

std::vector<Case> servo_cases() {
  return {
      {"S1",
       "ServoRampsToItsSpeed",
       "closed form: 2 N·m on 1 kg·m² to 1 rad/s: 0.75 rad after 1 s",
       {{"angle_rad", 5.1e-4},
        {"overshoot_rad_per_s", 1e-9},
        {"over_torque_nm", 1e-9},
        {"idle_torque_nm", 1e-6}},
       reach_speed},
      {"S1t",
       "ServoTurnsAQuarterByATrapezoid",
       "closed form: 90° at up to 1 rad/s and 2 N·m on 1 kg·m²; a tick at full speed is 1 mrad",
       {{"overshoot_deg", 0.1},
        {"over_speed_rad_per_s", 1e-9},
        {"over_torque_nm", 1e-9},
        {"place_rad", 2e-3},
        {"held_rad", 1e-5}},
       turn_a_quarter},
      {"S2",
       "SaturatedServoIsAConstantTorque",
       "closed form: t² / 2",
       {{"speed_rad_per_s", 1e-9}, {"angle_rad", 5.1e-4}, {"torque_nm", 1e-9}},
       saturate},
      {"S1h",
       "ServoHoldsALoad",
       "closed form: no motion, torque m g l",
       {{"sag_rad", 1e-6}, {"torque_nm", 1e-5}},
       hold_load},
      {"S3",
       "StopIsNotPassed",
       "closed form: position at most the limit",
       {{"beyond_rad", 1e-5}, {"speed_rad_per_s", 1e-6}},
       run_into_stop},
  };
}

}  // namespace visum::physics
