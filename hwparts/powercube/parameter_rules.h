// The parameters whose reading or writing needs more than one field: which values they take, and what writing
// them does. The bounds are the factory's. A value beyond is brought to the bound or refused, as
// Settings::above_maximum says. Setters return false where they refuse.
#pragma once

#include "hwparts/powercube/module_state.h"

namespace visum::powercube {

inline constexpr std::uint8_t kPositionStateDio = 0x62;
inline constexpr double kCurrentDigits = 500.0;  // at the current limit; m5api commands -500..500
inline constexpr double kVoltDigits = 100.0;     // per V: raw supply readings, unknown on real modules
inline constexpr double kDegreeDigits = 10.0;    // per °C

double inc(const ModuleView& view, double value);  // whole increments
double following_error(const ModuleView& view);
// [u]. For an axis that turns forever the limits are 1e6 rad away.
double factory_minimum(const ModuleView& view);
double factory_maximum(const ModuleView& view);
double minimum_position(const ModuleView& view);
double maximum_position(const ModuleView& view);

bool set_address(const ModuleEdit& edit, double value);
bool set_config(const ModuleEdit& edit, double value);
bool set_outputs(const ModuleEdit& edit, double value);
bool set_target_speed(const ModuleEdit& edit, double value);
bool set_target_acceleration(const ModuleEdit& edit, double value);
bool set_home_offset(const ModuleEdit& edit, double value);
bool set_home_speed(const ModuleEdit& edit, double value);
bool set_following_error(const ModuleEdit& edit, double value);
bool set_minimum_position(const ModuleEdit& edit, double value);
bool set_maximum_position(const ModuleEdit& edit, double value);
bool set_maximum_speed(const ModuleEdit& edit, double value);
bool set_maximum_acceleration(const ModuleEdit& edit, double value);
bool set_maximum_current(const ModuleEdit& edit, double value);

}  // namespace visum::powercube
