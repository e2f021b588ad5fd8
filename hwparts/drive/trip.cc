#include "hwparts/drive/trip.h"

#include <cmath>

#include "hwparts/drive/motor.h"
#include "hwparts/drive/state_word.h"
#include "protocol/config/number_text.h"

namespace visum::drive {
namespace {

constexpr std::uint32_t kFaults = state_bit::kTowError | state_bit::kCommError | state_bit::kBeyondSoft |
                                  state_bit::kBeyondHard | state_bit::kPowerStage;

// Significant digits.
constexpr int kDigits = 3, kMostDigits = 6;

std::string shown(double value, int digits = kDigits) {
  if (value == 0.0 || !std::isfinite(value)) return "0";
  const double scale = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
  return config::number_text(std::round(value * scale) / scale);
}

// With as many digits as tell it from the limit that it is above.
std::string shown_above(double value, double limit) {
  int digits = kDigits;
  while (digits < kMostDigits && shown(value, digits) == shown(limit, digits)) ++digits;
  return shown(value, digits);
}

std::string beyond(const char* which, double position, double target, double minimum, double maximum,
                   const std::string& unit) {
  return "at " + shown(position) + unit + " (desired " + shown(target) + unit + ") beyond a " + which +
         " limit, " + shown(minimum) + " to " + shown(maximum) + unit +
         "; command a place inside, then Reset, and look for what pushes the joint";
}

}  // namespace

std::uint32_t new_faults(std::uint32_t latched, std::uint32_t known) {
  return (latched & state_bit::kError) != 0 ? latched & ~known & kFaults : 0;
}

Trip figures_of(const DriveState& state) {
  return {0,
          state.setpoint.position - state.measured_position,
          state.measured_position,
          state.commanded,
          state.i2t,
          0.0,
          state.winding,
          state.tuning};
}

std::string trip_text(const DriveData& data, const Trip& trip) {
  const std::string unit = data.linear ? " m" : " rad";
  std::string text;
  const auto add = [&](std::uint32_t bit, const std::string& why) {
    if ((trip.bits & bit) != 0) text += (text.empty() ? "" : ". Also: ") + why;
  };
  add(state_bit::kTowError, "following error " +
                                shown_above(std::abs(trip.lag), trip.tuning.following_error) + unit +
                                " exceeds " + shown(trip.tuning.following_error) + unit +
                                "; look for what holds the joint or overloads it, move slower or accelerate "
                                "less, raise the gains or "
                                "Following Error Limit, then Reset");
  add(state_bit::kBeyondSoft,
      beyond("soft", trip.position, trip.target, trip.tuning.soft_minimum, trip.tuning.soft_maximum, unit));
  add(state_bit::kBeyondHard,
      beyond("hard", trip.position, trip.target, data.limits.hard_minimum, data.limits.hard_maximum, unit));
  add(state_bit::kPowVoltErr, "supply " + shown(trip.tuning.supply_voltage) + " V is below " +
                                  shown(data.supply.minimum_voltage) + " V; set Supply Voltage to " +
                                  shown(data.supply.nominal_voltage) +
                                  ", or release the emergency stop, then Reset");
  add(state_bit::kIntegralErr,
      "its current was above " + shown(data.motor.nominal_current) + " A for too long (" + shown(trip.i2t) +
          " of " + shown(i2t_budget(data.motor)) +
          " A²s); look for what it pushes against, lessen the load or the acceleration, or take a stronger "
          "motor; switch the supply off and on, " +
          (trip.rest_s > 0.0 ? "wait " + shown(std::ceil(trip.rest_s)) + " s, " : std::string()) +
          "then Reset");
  add(state_bit::kFetTemp,
      "winding at " + shown(trip.winding) + " °C exceeds " + shown(data.motor.maximum_winding) +
          " °C; lessen the load or let it cool, or take a stronger motor; switch the supply off and on, then "
          "Reset");
  add(state_bit::kCommError, "the controller was lost; connect again, then Reset");
  return text;
}

}  // namespace visum::drive
