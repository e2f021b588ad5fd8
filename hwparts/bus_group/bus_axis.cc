#include "hwparts/bus_group/bus_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "hwparts/bus_group/parameter_ids.h"
#include "hwparts/drive/state_word.h"

namespace visum::bus_group {
namespace {

namespace bit = drive::state_bit;
namespace command = powercube::command;
using powercube::Message;

constexpr std::uint8_t kRamp = 0x04, kVelocity = 0x07;
// Position and state are read twice as often as speed and current.
constexpr std::array<std::uint8_t, 6> kRound{kState, kPosition, kSpeed, kState, kPosition, kCurrent};

Message with_float(std::uint8_t command, std::uint8_t parameter, float value) {
  Message message{command, parameter};
  powercube::put_value(message, value);
  return message;
}

bool changes_state(std::uint8_t command) {
  return command == command::kReset || command == command::kHalt || command == command::kHome;
}

// Answers to SETPARAM and SETMOVE end with a byte that says whether the command was taken. Where it is
// missing, the command counts as taken.
bool refuses(const Message& answer) {
  const auto command = answer.command();
  const bool says_so = command == command::kSetParameter || command == command::kSetMove;
  return says_so && answer.size > 2 && answer.data[2] != powercube::kDone;
}

}  // namespace

BusAxis::BusAxis(const drive::DriveData& data, const Found& found)
    : data_(data), serial_number_(found.serial_number), settings_(limit_settings(data)) {
  if (found.watchdog) settings_.push_back(*found.watchdog);
  reading_.position = found.position;
  reading_.state = found.state;
}

std::uint32_t BusAxis::state_word() const {
  return reading_.state | (lost_ || comm_fault_ ? bit::kError | bit::kCommError : 0U);
}

bool BusAxis::moves() const {
  return has(bit::kMotion) || homing_ || move_sent_ || stand_wished_ || target_wished_ || has_wish();
}

void BusAxis::forget_motion() {
  target_wished_.reset();
  target_sent_.reset();
  stand_wished_ = home_wished_ = false;
  pause_ = 0;
}

// A halt is sent first of all. A reset that still waits would undo it, so another halt follows the reset.
void BusAxis::halt() {
  forget_motion();
  if (lost_) return;  // it is halted as soon as it answers again
  halt_wished_ = unsettled_ = true;
  halt_again_ = reset_wished_;
  homing_ = false;
}

// A reset brings the module's target speed back to its maximum, so the speed must be sent again.
void BusAxis::reset() {
  forget_motion();
  if (lost_) return;
  reset_wished_ = unsettled_ = true;
  halt_again_ = homing_ = false;
  speed_sent_.reset();
  if (comm_fault_) settings_left_ = settings_.size();
  comm_fault_ = false;
}

void BusAxis::home() {
  forget_motion();
  home_wished_ = unsettled_ = homing_ = true;
}

void BusAxis::follow(double target, double speed) {
  const auto new_target = static_cast<float>(target);
  const auto new_speed = static_cast<float>(std::min(speed, data_.limits.maximum_speed));
  if (new_speed <= 0.0F) return stand();
  const auto& last = target_wished_ ? target_wished_ : target_sent_;
  if (last == new_target && speed_wished_ == new_speed) return;
  target_wished_ = new_target;
  speed_wished_ = new_speed;
  stand_wished_ = false;
}

void BusAxis::stand() {
  if (halt_wished_ || stand_wished_) return;
  if (!target_wished_ && !target_sent_ && !ramp_sent_) return;
  forget_motion();
  stand_wished_ = true;
}

void BusAxis::set(std::uint8_t parameter, double value) {
  const auto message = with_float(command::kSetParameter, parameter, static_cast<float>(value));
  const auto same = [&](const Message& setting) { return setting.data[1] == parameter; };
  const auto known = std::ranges::find_if(settings_, same);
  if (known == settings_.end())
    settings_.push_back(message);
  else
    *known = message;
  settings_left_ = settings_.size();
}

bool BusAxis::has_wish() const {
  const bool motion = pause_ == 0 && (stand_wished_ || target_wished_);
  return !lost_ && (halt_wished_ || reset_wished_ || home_wished_ || motion || settings_left_ > 0);
}

Message BusAxis::next_request() {
  if (!has_wish()) return next_reading();
  if (std::exchange(halt_wished_, false)) {
    ramp_sent_ = false;
    return {command::kHalt};
  }
  if (std::exchange(reset_wished_, false)) {
    halt_wished_ = std::exchange(halt_again_, false);
    return {command::kReset};
  }
  if (pause_ == 0 && std::exchange(stand_wished_, false)) {
    move_sent_ = true;
    ramp_sent_ = false;
    return with_float(command::kSetMove, kVelocity, 0.0F);
  }
  if (settings_left_ > 0) return settings_[settings_.size() - settings_left_--];
  if (std::exchange(home_wished_, false)) {
    ramp_sent_ = false;
    return {command::kHome};
  }
  if (speed_sent_ != speed_wished_) {
    speed_sent_ = speed_wished_;
    return with_float(command::kSetParameter, kTargetSpeed, speed_wished_);
  }
  target_sent_ = *target_wished_;
  target_wished_.reset();
  move_sent_ = ramp_sent_ = true;
  return with_float(command::kSetMove, kRamp, *target_sent_);
}

Message BusAxis::next_reading() {
  if (lost_) return {command::kGetParameter, kSerialNumber};
  if (settling()) {
    state_asked_ = true;
    return {command::kGetParameter, kState};
  }
  return {command::kGetParameter, kRound[round_++ % kRound.size()]};
}

void BusAxis::take(const Message& request, const std::optional<Message>& answer) {
  if (!answer) return lose();
  const auto command = request.command();
  if (changes_state(command)) state_asked_ = false;
  if (refuses(*answer)) return take_refusal(request);
  if (command != command::kGetParameter) return;
  if (pause_ > 0) --pause_;
  take_reading(request.data[1], *answer);
}

// A refused motion is wished again, unless there is a newer wish. It waits for a round of readings, so that a
// module that goes on refusing does not fill the line. A refused setting is a fault, since the module works
// with a wrong one; reset() sends it again.
void BusAxis::take_refusal(const Message& request) {
  const auto parameter = request.data[1];
  const bool newer = halt_wished_ || reset_wished_ || home_wished_ || stand_wished_ || target_wished_;
  if (request.command() == command::kSetMove && parameter == kVelocity) {
    stand_wished_ |= !newer;
    ramp_sent_ = true;
  } else if (request.command() == command::kSetMove) {
    if (!newer) target_wished_ = target_sent_;
    target_sent_.reset();
  } else if (parameter == kTargetSpeed) {
    speed_sent_.reset();
  } else {
    comm_fault_ = true;
    return;
  }
  pause_ = kRound.size();
}

void BusAxis::take_reading(std::uint8_t parameter, const Message& answer) {
  if (answer.size < 6) return;
  const auto number = static_cast<double>(powercube::value_at<float>(answer, 2));
  const bool is_float = parameter == kPosition || parameter == kSpeed || parameter == kCurrent;
  if (is_float && !std::isfinite(number)) return;  // the reading before holds
  switch (parameter) {
    case kSerialNumber:
      return take_serial_number(powercube::value_at<std::uint32_t>(answer, 2));
    case kState:
      return take_state(powercube::value_at<std::uint32_t>(answer, 2));
    case kPosition:
      reading_.position = number;
      return;
    case kSpeed:
      reading_.speed = number;
      return;
    case kCurrent:
      reading_.current = number;
      return;
    default:
      return;
  }
}

void BusAxis::take_state(std::uint32_t state) {
  reading_.state = state;
  move_sent_ = false;
  if (pause_ > 0 && !(state & bit::kMotion))
    stand_wished_ = ramp_sent_ = false;  // a motion was refused, and the module stands: no stop is needed
  const bool wishes = halt_wished_ || reset_wished_ || home_wished_;
  if (state_asked_ && !wishes) unsettled_ = false;
  if (!homing_ || settling()) return;
  const bool over = (state & (bit::kError | bit::kHalted)) != 0;
  const bool done = (state & bit::kHomeOk) != 0 && (state & bit::kMotion) == 0;
  if (over || done) homing_ = false;
}

// A lost module is taken back only with the serial number that was surveyed. Another module stays lost,
// whatever it answers.
void BusAxis::take_serial_number(std::uint32_t number) {
  if (!lost_ || number != serial_number_) return;
  lost_ = false;
  halt();  // nothing is known of what it did meanwhile
}

void BusAxis::lose() {
  forget_motion();
  halt_wished_ = reset_wished_ = halt_again_ = false;
  ramp_sent_ = false;  // it is halted as soon as it answers again
  settings_left_ = 0;
  unsettled_ = false;
  homing_ = false;
  lost_ = comm_fault_ = true;
}

}  // namespace visum::bus_group
