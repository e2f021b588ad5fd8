#include "server/programs/drive_choice.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/number_text.h"

namespace visum::programs {
namespace {

using drive::ServoClass;
using hwparts::JointInfo;

constexpr double kSpeed = 2.0;               // rad/s, where the model gives none
constexpr double kLinearSpeed = 0.25;        // m/s
constexpr double kRampTime_s = 0.5;          // to full speed
constexpr double kHoldMargin = 1.3;          // nominal effort over gravity
constexpr double kPeakMargin = 1.2;          // peak effort over gravity and acceleration
constexpr double kMostRatio = 400.0;         // rad/rad
constexpr double kMostLinearRatio = 8000.0;  // rad/m: a pitch of 0.8 mm
constexpr double kLeastRatio = 20.0, kLeastLinearRatio = 200.0;
constexpr double kRatioStep = 1.05;
// Bandwidth of the velocity loop with the worst load, and most of it around the bare rotor: a tick of 1 ms
// and a speed filter of 2 ms leave enough phase there.
constexpr double kBandwidthPerS = 60.0, kMostBandwidthPerS = 250.0;
constexpr double kLoopRatio = 4.0;  // from velocity loop to position loop, and to the integral part
constexpr double kLeastFollowing = 0.05, kMostFollowing = 0.5;  // rad
constexpr double kLinearFollowing = 0.1;                        // m for each rad
constexpr double kFollowingMargin = 3.0;

double round_to(double value, int digits) {
  if (value == 0.0) return 0.0;
  const double scale = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

// Always downwards, for limits that must not be passed.
double floor_to(double value, int digits) {
  const double scale = std::pow(10.0, digits - 1 - std::floor(std::log10(value)));
  return std::floor(value * scale) / scale;
}

double wanted_speed(const JointInfo& joint) {
  if (joint.maximum_speed > 0.0) return joint.maximum_speed;
  return joint.prismatic ? kLinearSpeed : kSpeed;
}

double reflected(const ServoClass& servo, double ratio) {
  return servo.rotor_inertia * ratio * ratio;
}

// True if the velocity loop reaches two thirds of its bandwidth with the load.
bool is_stiff_enough(const ServoClass& servo, double ratio, const JointLoad& load) {
  const double rotor = reflected(servo, ratio);
  return kMostBandwidthPerS * rotor >= 0.67 * kBandwidthPerS * (rotor + load.inertia);
}

// True if the motor behind this gear holds and moves the load.
bool is_strong_enough(const ServoClass& servo, double ratio, double speed, const JointLoad& load) {
  const double acceleration = speed / kRampTime_s;
  const double peak = load.gravity + (load.inertia + reflected(servo, ratio)) * acceleration;
  return drive::nominal_effort(servo, ratio) >= kHoldMargin * load.gravity &&
         drive::peak_effort(servo, ratio) >= kPeakMargin * peak;
}

void set_gear(const JointInfo& joint, const JointLoad& load, DriveChoice& choice) {
  const double least = joint.prismatic ? kLeastLinearRatio : kLeastRatio;
  const double most = joint.prismatic ? kMostLinearRatio : kMostRatio;
  const double wanted = wanted_speed(joint);
  for (const ServoClass& servo : drive::servo_classes()) {
    choice.servo = &servo;
    choice.ratio = std::clamp(drive::ratio_for_speed(servo, wanted), least, most);
    choice.speed = std::min(wanted, drive::usable_speed(servo, choice.ratio));
    if (is_strong_enough(servo, choice.ratio, choice.speed, load) &&
        is_stiff_enough(servo, choice.ratio, load))
      return;
  }
  while (choice.ratio < most && !is_strong_enough(*choice.servo, choice.ratio, choice.speed, load)) {
    choice.ratio = std::min(most, kRatioStep * choice.ratio);
    choice.speed = std::min(wanted, drive::usable_speed(*choice.servo, choice.ratio));
  }
}

void set_limits(const JointInfo& joint, const JointLoad& load, DriveChoice& choice) {
  const ServoClass& servo = *choice.servo;
  choice.ratio = round_to(choice.ratio, 3);
  choice.speed = floor_to(std::min(choice.speed, drive::usable_speed(servo, choice.ratio)), 3);
  choice.rotor_inertia = reflected(servo, choice.ratio);
  const double room = drive::peak_effort(servo, choice.ratio) / kPeakMargin - load.gravity;
  const double reached = std::max(0.1 * choice.speed, room / (load.inertia + choice.rotor_inertia));
  choice.acceleration = floor_to(std::min(choice.speed / kRampTime_s, reached), 2);
  const double peak_a = drive::peak_effort(servo, 1.0) / servo.torque_constant;
  choice.current_limit = peak_a;
  if (joint.maximum_effort > 0.0)
    choice.current_limit = round_to(std::clamp(joint.maximum_effort / (servo.torque_constant * choice.ratio),
                                               servo.nominal_current, peak_a),
                                    3);
}

void set_gains(const JointInfo& joint, const JointLoad& load, DriveChoice& choice) {
  const double total = choice.rotor_inertia + load.inertia;
  const double around_rotor = kBandwidthPerS * total / choice.rotor_inertia;
  choice.velocity_bandwidth = floor_to(std::min(kMostBandwidthPerS, around_rotor), 2);
  const double bandwidth = choice.velocity_bandwidth * choice.rotor_inertia / total;
  choice.position_gain = round_to(bandwidth / kLoopRatio, 2);
  choice.integral_time = round_to(kLoopRatio / bandwidth, 2);
  choice.kd = round_to(choice.velocity_bandwidth * choice.rotor_inertia, 4);
  choice.kp = round_to(choice.position_gain * choice.kd, 4);
  const double unit = joint.prismatic ? kLinearFollowing : 1.0;
  const double lag = (load.gravity + total * choice.acceleration) / choice.kp;
  choice.following_error =
      round_to(std::clamp(kFollowingMargin * lag, unit * kLeastFollowing, unit * kMostFollowing), 2);
}

// Tells what the model left open, and what no class can do.
void list_missing(const JointInfo& joint, const JointLoad& load, DriveChoice& choice) {
  const auto say = [&](const std::string& what) { choice.missing.push_back(joint.name + ": " + what); };
  const std::string unit = joint.prismatic ? "m/s" : "rad/s";
  const std::string force = joint.prismatic ? " N" : " N·m";
  const auto number = [](double value) { return config::number_text(round_to(value, 3)); };
  if (joint.maximum_speed <= 0.0)
    say("the model's <limit> has no velocity; " + number(wanted_speed(joint)) + " " + unit + " is assumed");
  if (joint.lower > joint.upper && joint.prismatic)
    say("the model gives no stops; limits of ±1 m are assumed");
  if (load.inertia <= 0.0) say("nothing behind it has mass");
  if (choice.speed < 0.99 * wanted_speed(joint))
    say("no class of the catalogue is strong enough at " + number(wanted_speed(joint)) + " " + unit +
        "; it is geared down to " + number(choice.speed) + " " + unit);
  if (drive::nominal_effort(*choice.servo, choice.ratio) < load.gravity)
    say("it needs " + number(load.gravity) + force + " against gravity, and " + choice.servo->name +
        " can give " + number(drive::nominal_effort(*choice.servo, choice.ratio)) + force +
        " for ever: it will overheat; give its motor by hand, or use ideal_joints");
}

}  // namespace

DriveChoice choose_drive(const JointInfo& joint, const JointLoad& load) {
  DriveChoice choice;
  set_gear(joint, load, choice);
  set_limits(joint, load, choice);
  set_gains(joint, load, choice);
  list_missing(joint, load, choice);
  return choice;
}

}  // namespace visum::programs
