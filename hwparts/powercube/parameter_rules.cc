#include "hwparts/powercube/parameter_rules.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "hwparts/powercube/message.h"

namespace visum::powercube {
namespace {

using drive::Tuning;

constexpr double kEndless = 1e6;  // rad

// `value`, brought into [least, most]. Nothing where it lies outside and the settings refuse that.
std::optional<double> bounded(const ModuleEdit& edit, double value, double least, double most) {
  const bool inside = value >= least && value <= most;
  if (!inside && edit.settings.above_maximum == AboveMaximum::kRefuse) return std::nullopt;
  return std::clamp(value, least, most);
}

// The same for speeds, accelerations and currents, which some clients write with a sign. 0 is refused.
std::optional<double> bounded_size(const ModuleEdit& edit, double value, double most) {
  const double size = std::abs(value);
  return size > 0.0 ? bounded(edit, size, 0.0, most) : std::nullopt;
}

bool put(double& to, const std::optional<double>& value) {
  if (value) to = *value;
  return value.has_value();
}

bool tune(const ModuleEdit& edit, double Tuning::*field, const std::optional<double>& value) {
  if (value) edit.drive.tune(field, *value);
  return value.has_value();
}

// Limits mean homed positions. Before homing, they are taken as homing will make them.
double offset_when_homed(const ModuleEdit& edit) {
  const auto& drive = edit.drive.state();
  return drive.referenced ? drive.zero_offset : drive.home_offset;
}
double hard_minimum(const ModuleEdit& edit) {
  return edit.data.limits.hard_minimum + offset_when_homed(edit);
}
double hard_maximum(const ModuleEdit& edit) {
  return edit.data.limits.hard_maximum + offset_when_homed(edit);
}

// A bound that went to the client as binary32 comes back slightly off. This gives the bound itself then.
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

// All bits can be written except LINEAR, which follows from how the module is built.
bool set_config(const ModuleEdit& edit, double value) {
  const auto word = static_cast<std::uint32_t>(value);
  edit.module.config = (word & ~config_bit::kLinear) | (edit.settings.config & config_bit::kLinear);
  edit.drive.set_zero_after_home((word & config_bit::kZeroMoveAfterHome) != 0);
  if (!(word & config_bit::kWatchdogEnable)) edit.module.watchdog_armed = false;
  return true;
}

bool set_outputs(const ModuleEdit& edit, double value) {
  edit.module.outputs = static_cast<std::uint8_t>(static_cast<std::uint32_t>(value) & 0xF0);
  return true;
}

// 0 is taken as a speed, too: a client that writes it wants no motion, and least of all one at the last
// speed.
bool set_target_speed(const ModuleEdit& edit, double value) {
  const double most = edit.drive.state().tuning.maximum_speed;
  return put(edit.module.target_speed, bounded(edit, std::abs(value), 0.0, most));
}

bool set_target_acceleration(const ModuleEdit& edit, double value) {
  const double most = edit.drive.state().tuning.maximum_acceleration;
  return put(edit.module.target_acceleration, bounded_size(edit, value, most));
}

// The position shows it after the next Reset or homing.
bool set_home_offset(const ModuleEdit& edit, double value) {
  if (std::abs(value) > kEndless) return false;
  edit.drive.set_home_offset(from_increments(edit, inc(edit, value - edit.data.home.position)));
  return true;
}

bool set_home_speed(const ModuleEdit& edit, double value) {
  return tune(edit, &Tuning::home_speed, bounded_size(edit, value, edit.data.limits.maximum_speed));
}

bool set_following_error(const ModuleEdit& edit, double value) {
  if (value < edit.data.increment() || value > 1e3) return false;
  edit.drive.tune(&Tuning::following_error, value);
  return true;
}

bool set_minimum_position(const ModuleEdit& edit, double value) {
  const auto& tuning = edit.drive.state().tuning;
  value = not_beyond_by_rounding(value, edit.data.limits.soft_minimum);
  if (!edit.data.limits.limited || value >= tuning.soft_maximum) return false;
  return tune(edit, &Tuning::soft_minimum, bounded(edit, value, hard_minimum(edit), hard_maximum(edit)));
}

bool set_maximum_position(const ModuleEdit& edit, double value) {
  const auto& tuning = edit.drive.state().tuning;
  value = not_beyond_by_rounding(value, edit.data.limits.soft_maximum);
  if (!edit.data.limits.limited || value <= tuning.soft_minimum) return false;
  return tune(edit, &Tuning::soft_maximum, bounded(edit, value, hard_minimum(edit), hard_maximum(edit)));
}

bool set_maximum_speed(const ModuleEdit& edit, double value) {
  const double most = edit.data.limits.maximum_speed;
  return tune(edit, &Tuning::maximum_speed, bounded_size(edit, not_beyond_by_rounding(value, most), most));
}

bool set_maximum_acceleration(const ModuleEdit& edit, double value) {
  const double most = edit.data.limits.maximum_acceleration;
  return tune(edit, &Tuning::maximum_acceleration,
              bounded_size(edit, not_beyond_by_rounding(value, most), most));
}

bool set_maximum_current(const ModuleEdit& edit, double value) {
  const double most = edit.data.motor.current_limit;
  return tune(edit, &Tuning::maximum_current, bounded_size(edit, not_beyond_by_rounding(value, most), most));
}

}  // namespace visum::powercube
