#include "clients/examples/quadruped/walker.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace visum::quadruped {
namespace {

constexpr double kStandFor_s = 0.5;    // at first, and in the end
constexpr double kStride_s = 0.4;      // lift to lift of one leg
constexpr double kLastStrides = 2.0;   // on the spot
constexpr double kHeight = 0.30;       // of the trunk over the feet's centres
constexpr double kClearance = 0.05;    // how high a foot is lifted
constexpr double kAcceleration = 0.5;  // m/s²
constexpr double kWeight_N = 12.0 * 9.81;
constexpr double kTurnBack_per_s = 2.0, kFastestTurn = 0.5;
constexpr double kShiftBack_per_s = 0.5, kFastestShift = 0.1;
constexpr double kCatch_s = 0.08;  // a foot lands so far ahead for each m/s of speed too much
constexpr double kLevel_N = 60.0, kLevelDamping_Ns = 6.0;

// Diagonal legs swing together; the pairs take turns.
constexpr std::array<double, kLegs> kOffset = {0.0, 0.5, 0.5, 0.0};

Vector3d neutral(int leg) {
  return {kLeg[leg].hip.x(), kLeg[leg].hip.y() + kLeg[leg].thigh_offset, -kHeight};
}

// From 0 to 1 without a jolt at both ends.
double smooth(double s) {
  return s * s * (3.0 - 2.0 * s);
}

// From 0 to 1 and back, without a jolt at both ends.
double arch(double s) {
  const double rest = 1.0 - s;
  return 16.0 * s * s * rest * rest;
}

double toward(double from, double to, double most) {
  return from + std::clamp(to - from, -most, most);
}

}  // namespace

bool Walker::steps() const {
  return phase_ == Phase::kWalk || phase_ == Phase::kBrake;
}

Walker::Phase Walker::next_phase() const {
  const bool all_stand = std::all_of(stands_.begin(), stands_.end(), [](bool stands) { return stands; });
  const double braking = forward_ * forward_ / (2.0 * kAcceleration);
  switch (phase_) {
    case Phase::kStand:
      return time_ >= kStandFor_s ? Phase::kWalk : phase_;
    case Phase::kWalk:
      return motion_.way() + braking >= course_.distance ? Phase::kBrake : phase_;
    case Phase::kBrake: {
      const double stopped = course_.speed / kAcceleration + kLastStrides * kStride_s;
      return time_ >= stopped && all_stand ? Phase::kRest : phase_;
    }
    case Phase::kRest:
      return time_ >= kStandFor_s ? Phase::kDone : phase_;
    case Phase::kDone:
      break;
  }
  return phase_;
}

void Walker::choose_speed() {
  forward_ = toward(forward_, phase_ == Phase::kWalk ? course_.speed : 0.0, kAcceleration * kCycle);
  turn_ = steps() ? std::clamp(-kTurnBack_per_s * motion_.heading(), -kFastestTurn, kFastestTurn) : 0.0;
  left_ = steps() ? std::clamp(-kShiftBack_per_s * motion_.drift(), -kFastestShift, kFastestShift) : 0.0;
}

// A foot lands so that the trunk passes over it in the middle of its stand; further ahead if the trunk is too
// fast (Raibert, "Legged Robots That Balance", 1986, section 2).
Vector3d Walker::landing(int leg) const {
  const Vector3d wanted(forward_, left_, 0.0), spin(0.0, 0.0, turn_);
  Vector3d too_much = motion_.velocity() - wanted;
  too_much.z() = 0.0;
  const double half_stand = 0.5 * (1.0 - kSwing) * kStride_s;
  return neutral(leg) + half_stand * (wanted + spin.cross(neutral(leg))) + kCatch_s * too_much;
}

void Walker::step_feet() {
  if (steps()) stride_ += kCycle / kStride_s;
  if (stride_ >= 1.0) stride_ -= 1.0;
  const Vector3d velocity(forward_, left_, 0.0), spin(0.0, 0.0, turn_);
  for (int i = 0; i < kLegs; ++i) {
    double at = stride_ + kOffset[i];
    if (at >= 1.0) at -= 1.0;
    const double swing = at / kSwing;  // below 1 while the leg is in the air
    if (!steps() || swing >= 1.0) {
      place_[i] -= kCycle * (velocity + spin.cross(place_[i]));
      place_[i].z() = toward(place_[i].z(), -kHeight, 0.2 * kCycle);
      stands_[i] = true;
      continue;
    }
    if (stands_[i]) lifted_[i] = place_[i];
    stands_[i] = false;
    place_[i] = lifted_[i] + smooth(swing) * (landing(i) - lifted_[i]);
    place_[i].z() += kClearance * arch(swing);
  }
}

Commands Walker::command(const Readings& now) {
  Commands commands;
  double share[kLegs], sum = 0.0;
  for (int i = 0; i < kLegs; ++i) {
    double at = stride_ + kOffset[i];
    if (at >= 1.0) at -= 1.0;
    const double stand = (at - kSwing) / (1.0 - kSwing);
    share[i] = !steps() ? 1.0 : stands_[i] ? std::clamp(std::min(stand, 1.0 - stand) / 0.15, 0.05, 1.0) : 0.0;
    sum += share[i];
  }
  const Vector3d& up = motion_.up();
  for (int i = 0; i < kLegs; ++i) {
    const Leg& leg = kLeg[i];
    commands.angles[i] = angles_for(leg, place_[i]);
    commands.speeds[i] =
        begun_ ? Vector3d((commands.angles[i] - last_angles_[i]) / kCycle) : Vector3d::Zero();
    last_angles_[i] = commands.angles[i];
    // The ground carries the trunk, and more of it where the trunk leans to.
    const double x = kLeg[i].hip.x() > 0 ? 1.0 : -1.0, y = kLeg[i].hip.y() > 0 ? 1.0 : -1.0;
    double force = kWeight_N * share[i] / std::max(sum, 0.5);
    if (stands_[i])
      force += kLevel_N * (-x * up.x() - y * up.y()) +
               kLevelDamping_Ns * (x * motion_.rate().y() - y * motion_.rate().x());
    commands.efforts[i] =
        stands_[i] ? Vector3d(jacobian(leg, now.angles[i]).transpose() * (-std::max(force, 0.0) * up))
                   : Vector3d::Zero();
  }
  begun_ = true;
  return commands;
}

Commands Walker::cycle(const Readings& now) {
  if (!begun_)
    for (int i = 0; i < kLegs; ++i) place_[i] = foot(kLeg[i], now.angles[i]);
  motion_.update(now, stands_, phase_ == Phase::kStand);
  const Phase next = next_phase();
  time_ = next == phase_ ? time_ + kCycle : 0.0;
  phase_ = next;
  choose_speed();
  step_feet();
  return command(now);
}

}  // namespace visum::quadruped
