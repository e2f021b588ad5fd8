#include "hwparts/powercube/parameter_rules.h"

#include <algorithm>
#include <cmath>

#include "hwparts/powercube/message.h"

namespace visum::powercube {
namespace {

constexpr double kEndless = 1e6;  // rad

// Writes `value` where it is inside of [least, most], or brings it there.
bool set_bounded(const ModuleEdit& edit, double& field, double value, double least, double most) {
  if (value < least || value > most) {
    if (edit.settings.above_maximum == AboveMaximum::kRefuse) return false;
    value = std::clamp(value, least, most);
  }
  field = value;
  return true;
}

// Speeds and accelerations: some clients write the sign along.
bool set_size(const ModuleEdit& edit, double& field, double value, double most) {
  const double size = std::abs(value);
  return size > 0.0 && set_bounded(edit, field, size, 0.0, most);
}

// Limits are of homed positions: before that, as homing will have them.
double offset_when_homed(const ModuleEdit& edit) {
  return edit.drive.referenced ? edit.drive.zero_offset : edit.drive.home_offset;
}
double hard_minimum(const ModuleEdit& edit) {
  return edit.data.limits.hard_minimum + offset_when_homed(edit);
}
double hard_maximum(const ModuleEdit& edit) {
  return edit.data.limits.hard_maximum + offset_when_homed(edit);
}

// A binary32 value comes back a little beside the double that it was made of.
double not_beyond_by_rounding(double value, double bound) {
  return static_cast<float>(value) == static_cast<float>(bound) ? bound : value;
}

}  // namespace

double inc(const ModuleView& view, double value) {
  return to_increments(view, value);
}

double following_error(const ModuleView& view) {
  return view.drive.setpoint.position - view.drive.measured_position;
}

double factory_minimum(const ModuleView& view) {
  return view.data.limits.limited ? view.data.limits.soft_minimum : -kEndless;
}
double factory_maximum(const ModuleView& view) {
  return view.data.limits.limited ? view.data.limits.soft_maximum : kEndless;
}
double minimum_position(const ModuleView& view) {
  return view.data.limits.limited ? view.drive.tuning.soft_minimum : -kEndless;
}
double maximum_position(const ModuleView& view) {
  return view.data.limits.limited ? view.drive.tuning.soft_maximum : kEndless;
}

bool set_address(const ModuleEdit& edit, double value) {
  if (value < 1 || value > kMaxModule) return false;
  edit.module.address = static_cast<std::uint8_t>(value);
  return true;
}

// Whether a module is linear is how it is built.
bool set_config(const ModuleEdit& edit, double value) {
  const auto word = static_cast<std::uint32_t>(value);
  edit.module.config = (word & ~config_bit::kLinear) | (edit.settings.config & config_bit::kLinear);
  edit.drive.zero_after_home = (word & config_bit::kZeroMoveAfterHome) != 0;
  if (!(word & config_bit::kWatchdogEnable)) edit.module.watchdog_armed = false;
  return true;
}

bool set_outputs(const ModuleEdit& edit, double value) {
  edit.module.outputs = static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) & 0xF0);
  return true;
}

// 0 is a speed, too: a client that writes it wants no motion, least of all one as fast as the last.
bool set_target_speed(const ModuleEdit& edit, double value) {
  return set_bounded(edit, edit.module.target_speed, std::abs(value), 0.0, edit.drive.tuning.maximum_speed);
}

bool set_target_acceleration(const ModuleEdit& edit, double value) {
  return set_size(edit, edit.module.target_acceleration, value, edit.drive.tuning.maximum_acceleration);
}

// Seen in the position after the next Reset or homing.
bool set_home_offset(const ModuleEdit& edit, double value) {
  if (std::abs(value) > kEndless) return false;
  edit.drive.home_offset = from_increments(edit, inc(edit, value - edit.data.home.position));
  return true;
}

bool set_home_speed(const ModuleEdit& edit, double value) {
  return set_size(edit, edit.drive.tuning.home_speed, value, edit.data.limits.maximum_speed);
}

bool set_following_error(const ModuleEdit& edit, double value) {
  if (value < edit.data.increment() || value > 1e3) return false;
  edit.drive.tuning.following_error = value;
  return true;
}

bool set_minimum_position(const ModuleEdit& edit, double value) {
  auto& tuning = edit.drive.tuning;
  value = not_beyond_by_rounding(value, edit.data.limits.soft_minimum);
  if (!edit.data.limits.limited || value >= tuning.soft_maximum) return false;
  return set_bounded(edit, tuning.soft_minimum, value, hard_minimum(edit), hard_maximum(edit));
}

bool set_maximum_position(const ModuleEdit& edit, double value) {
  auto& tuning = edit.drive.tuning;
  value = not_beyond_by_rounding(value, edit.data.limits.soft_maximum);
  if (!edit.data.limits.limited || value <= tuning.soft_minimum) return false;
  return set_bounded(edit, tuning.soft_maximum, value, hard_minimum(edit), hard_maximum(edit));
}

bool set_maximum_speed(const ModuleEdit& edit, double value) {
  return set_size(edit, edit.drive.tuning.maximum_speed,
                  not_beyond_by_rounding(value, edit.data.limits.maximum_speed),
                  edit.data.limits.maximum_speed);
}

bool set_maximum_acceleration(const ModuleEdit& edit, double value) {
  return set_size(edit, edit.drive.tuning.maximum_acceleration,
                  not_beyond_by_rounding(value, edit.data.limits.maximum_acceleration),
                  edit.data.limits.maximum_acceleration);
}

bool set_maximum_current(const ModuleEdit& edit, double value) {
  return set_size(edit, edit.drive.tuning.maximum_current,
                  not_beyond_by_rounding(value, edit.data.motor.current_limit),
                  edit.data.motor.current_limit);
}

}  // namespace visum::powercube
