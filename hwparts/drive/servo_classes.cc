#include "hwparts/drive/servo_classes.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace visum::drive {
namespace {

constexpr double kRpm = 2.0 * std::numbers::pi / 60.0;  // rad/s
constexpr double kGcm2 = 1e-7;                          // kg·m²

// Sources: DRIVES.md.
constexpr std::array<ServoClass, 2> kClasses{{
    {"60W", "maxon RE 30, 48 V", 48, 8490 * kRpm, 0.0786, 0.0897, 1.74, 2.45, 0.0538, 34.7 * kGcm2, 1.7 + 6.0,
     16.9, 125},
    {"250W", "maxon RE 65, 353297", 48, 3670 * kRpm, 0.289, 0.800, 6.80, 0.365, 0.123, 1340 * kGcm2,
     1.85 + 1.3, 123, 125},
}};

// Choices of ours. DRIVES.md gives the reasons.
constexpr double kPeakCurrent = 3.0;     // nominal currents
constexpr double kPeakTime = 0.1;        // of the winding's time constant
constexpr double kUsableSpeed = 0.8;     // of the no-load speed
constexpr double kRotaryRatio = 100.0;   // where the model gives no speed
constexpr double kLinearRatio = 1000.0;  // rad/m: a screw with a pitch of 6.3 mm
constexpr double kLeastRatio = 20.0, kMostRatio = 200.0;
constexpr double kBreaking = 2.0;  // peak efforts of the motor
constexpr double kIncrements = 4096.0;
constexpr double kRampTime_s = 0.5;       // to full speed
constexpr double kStop = 2.0;             // times the acceleration
constexpr double kFollowing_s = 0.1;      // full speed for so long
constexpr double kBandwidthPerS = 100.0;  // of the velocity loop around the bare rotor
constexpr double kPositionGainPerS = 15.0;
constexpr double kIntegral_s = 0.08;
constexpr double kHomeSpeed = 0.25;          // of the full speed
constexpr double kMinimumSupply = 0.75;      // of the nominal voltage
constexpr double kTolerance = 0.002;         // rad
constexpr double kLinearTolerance = 0.0002;  // m

MotorData motor_of(const ServoClass& servo) {
  MotorData motor;
  motor.torque_constant = servo.torque_constant;
  motor.resistance = servo.resistance;
  motor.nominal_current = servo.nominal_current;
  motor.current_limit = kPeakCurrent * servo.nominal_current;
  motor.peak_time = kPeakTime * servo.thermal_time_winding;
  motor.thermal_resistance = servo.thermal_resistance;
  motor.thermal_time = servo.thermal_time_winding;
  motor.ambient = 25.0;
  motor.maximum_winding = servo.maximum_winding;
  return motor;
}

// All losses without a load count as viscous, so that at rest the current carries the load alone.
GearData gear_of(const ServoClass& servo, double ratio) {
  GearData gear;
  gear.ratio = ratio;
  gear.rotor_inertia = servo.rotor_inertia;
  gear.viscous_friction = ratio * ratio * servo.torque_constant * servo.no_load_current / servo.no_load_speed;
  gear.peak_effort = peak_effort(servo, ratio);
  gear.breaking_effort = kBreaking * gear.peak_effort;
  return gear;
}

LimitData limits_of(const ServoClass& servo, double ratio, bool linear, const JointBounds& joint) {
  LimitData limits;
  const double reached = usable_speed(servo, ratio);
  limits.maximum_speed = joint.maximum_speed > 0.0 ? std::min(joint.maximum_speed, reached) : reached;
  limits.maximum_acceleration = limits.maximum_speed / kRampTime_s;
  limits.stop_deceleration = kStop * limits.maximum_acceleration;
  limits.following_error = kFollowing_s * limits.maximum_speed;
  limits.tolerance = linear ? kLinearTolerance : kTolerance;
  limits.limited = joint.lower < joint.upper;
  if (!limits.limited) return limits;
  limits.soft_minimum = limits.hard_minimum = joint.lower;
  limits.soft_maximum = limits.hard_maximum = joint.upper;
  return limits;
}

}  // namespace

std::span<const ServoClass> servo_classes() {
  return kClasses;
}

std::vector<std::string> servo_class_names() {
  std::vector<std::string> names;
  for (const auto& servo : kClasses) names.emplace_back(servo.name);
  return names;
}

const ServoClass* find_servo_class(const std::string& name) {
  const auto found = std::ranges::find_if(kClasses, [&](const auto& servo) { return name == servo.name; });
  return found == kClasses.end() ? nullptr : &*found;
}

double nominal_effort(const ServoClass& servo, double ratio) {
  return servo.nominal_torque * ratio;
}

double peak_effort(const ServoClass& servo, double ratio) {
  return kPeakCurrent * servo.nominal_current * servo.torque_constant * ratio;
}

double usable_speed(const ServoClass& servo, double ratio) {
  return kUsableSpeed * servo.no_load_speed / ratio;
}

double ratio_for_speed(const ServoClass& servo, double speed) {
  return kUsableSpeed * servo.no_load_speed / speed;
}

double default_ratio(const ServoClass& servo, bool linear, const JointBounds& joint) {
  const double usual = linear ? kLinearRatio : kRotaryRatio;
  if (joint.maximum_speed <= 0.0) return usual;
  const double scale = linear ? kLinearRatio / kRotaryRatio : 1.0;
  return std::clamp(ratio_for_speed(servo, joint.maximum_speed), scale * kLeastRatio, scale * kMostRatio);
}

DriveData class_defaults(const ServoClass& servo, double ratio, bool linear, const JointBounds& joint) {
  DriveData data;
  data.type = servo.motor;
  data.module = joint.number;
  data.linear = linear;
  data.motor = motor_of(servo);
  data.gear = gear_of(servo, ratio);
  data.encoder.increments_per_turn = kIncrements;
  data.limits = limits_of(servo, ratio, linear, joint);
  data.loop = {kPositionGainPerS, kBandwidthPerS, kIntegral_s, 0.002};
  data.home.position = data.limits.limited ? std::clamp(0.0, joint.lower, joint.upper) : 0.0;
  data.home.speed = kHomeSpeed * data.limits.maximum_speed;
  data.supply = {servo.nominal_voltage, kMinimumSupply * servo.nominal_voltage};
  return data;
}

}  // namespace visum::drive
