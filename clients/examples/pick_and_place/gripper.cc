#include "clients/examples/pick_and_place/gripper.h"

#include <algorithm>

namespace visum::pick_and_place {
namespace {

constexpr double kRoom_m = 0.010;  // beside the object, on each side
constexpr double kStill_m_per_s = 0.0005;
constexpr int kStillTicks = 10;                  // as many ticks in a row
constexpr int kMaxTicks = 800;                   // a finger's whole way takes a fraction of that
constexpr double kClosingSpeed_m_per_s = 0.012;  // touches softly
constexpr double kHeldShare = 0.4;  // of the squeeze; an object keeps the fingers from at least this share

}  // namespace

void Gripper::open_for(double width_m) {
  desired_m_ = std::min(0.5 * width_m + kRoom_m, upper_m_ - 0.001);
  arm_.command_fingers(desired_m_, arm_.maximum_finger_speed());
  wait_until_still();
}

bool Gripper::close_on(double width_m) {
  desired_m_ = std::max(0.0, 0.5 * width_m - squeeze_m_);
  arm_.command_fingers(desired_m_, std::min(kClosingSpeed_m_per_s, arm_.maximum_finger_speed()));
  wait_until_still();
  return holds();
}

bool Gripper::holds() const {
  const auto positions = arm_.finger_positions();
  return std::all_of(positions.begin(), positions.end(),
                     [this](double position) { return position > desired_m_ + kHeldShare * squeeze_m_; });
}

void Gripper::wait_until_still() {
  int still = 0;
  for (int tick = 0; still < kStillTicks; ++tick) {
    if (tick == kMaxTicks) throw DriveFault("the gripper does not come to rest");
    arm_.tick();
    still = arm_.largest_finger_speed() < kStill_m_per_s ? still + 1 : 0;
  }
}

}  // namespace visum::pick_and_place
