#include "hwparts/powercube/parameters.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hwparts/powercube/parameter_rules.h"

namespace visum::powercube {
namespace {

using V = const ModuleView&;
using E = const ModuleEdit&;
using T = ValueType;

// The parameters that are only kept, by their place in ModuleState::kept.
enum Kept : std::size_t {
  kC0,
  kDamp,
  kA0,
  kDefDio,
  kSyncTime,
  kLoadLimit,
  kLoadGradient,
  kLoadTime,
  kMinLogic,
  kMaxLogic,
  kMaxMotor,
  kKpPwm,
  kLogicUnder,
  kLogicOver,
  kMotorUnder,
  kMotorOver,
  kNominalOver,
  kCanBaud,
  kRsBaud,
};
static_assert(kRsBaud + 1 == kKept);

template <Kept place>
double kept(V v) {
  return v.module.kept[place];
}
template <Kept place>
bool keep(E e, double value) {
  e.module.kept[place] = value;
  return true;
}

// Takes only the present value. Nothing here acts on the parameter, so acknowledging another value would be a
// lie.
template <Kept place>
bool same(E e, double value) {
  return static_cast<float>(value) == static_cast<float>(e.module.kept[place]);
}

double no(V) {
  return 0.0;
}
double position_to_home(V v) {
  return v.data.home.position + v.drive.home_offset;
}

// Motor, gear, encoder.
constexpr Parameter kMachine[] = {
    {0x01, T::kFloat, Since::kAlways, [](V v) { return v.data.linear ? 1.0 : v.data.gear.ratio; }, nullptr},
    {0x02, T::kFloat, Since::kAlways, [](V v) { return v.data.linear ? 1.0 / v.data.gear.ratio : 1.0; },
     nullptr},
    {0x07, T::kFloat, Since::kAlways, [](V v) { return v.data.effort_per_amp(); }, nullptr},
    {0x08, T::kFloat, Since::kAlways, [](V v) { return v.data.motor.current_limit / kCurrentDigits; },
     nullptr},
    {0x1A, T::kUint32, Since::kAlways, [](V v) { return double(v.settings.serial_number); }, nullptr},
    {0x1B, T::kUint32, Since::kAlways, [](V v) { return double(v.settings.config); }, nullptr},
    {0x1C, T::kUint32, Since::kAlways, [](V v) { return v.data.encoder.increments_per_turn; }, nullptr},
    {0x1D, T::kUint16, Since::kAlways, [](V v) { return double(v.settings.firmware); }, nullptr},
    {0x1F, T::kUint16, Since::kAlways, [](V v) { return std::round(v.drive.tuning.brake_engage_time * 1e3); },
     [](E e, double value) { return e.drive.tune(&drive::Tuning::brake_engage_time, value * 1e-3), true; }},
    {0x20, T::kUint8, Since::kAlways, [](V v) { return double(v.module.address); }, set_address},
    {0x22, T::kUint8, Since::kAlways, kept<kCanBaud>,
     [](E e, double b) { return b <= 3 && keep<kCanBaud>(e, b); }},
    {0x23, T::kUint8, Since::kAlways, kept<kRsBaud>,
     [](E e, double b) { return b <= 7 && keep<kRsBaud>(e, b); }},
    {0x39, T::kUint32, Since::kAlways, [](V v) { return double(v.module.config); }, set_config},
    {0x3B, T::kFloat, Since::kAlways, [](V v) { return 1.0 / v.data.increment(); }, nullptr},
    {0x51, T::kInt16, Since::kAlways, [](V v) { return factory_values(v.data)[kC0]; }, nullptr},
    {0x52, T::kInt16, Since::kAlways, [](V v) { return factory_values(v.data)[kDamp]; }, nullptr},
    {0x53, T::kInt16, Since::kAlways, [](V v) { return factory_values(v.data)[kA0]; }, nullptr},
    {0x54, T::kInt16, Since::kAlways, kept<kC0>,
     [](E e, double c) { return c >= 12 && c <= 64 && std::fmod(c, 2.0) == 0.0 && keep<kC0>(e, c); }},
    {0x55, T::kInt16, Since::kAlways, kept<kDamp>,
     [](E e, double d) { return d >= 1 && d <= 4 && keep<kDamp>(e, d); }},
    {0x56, T::kInt16, Since::kAlways, kept<kA0>,
     [](E e, double a) { return a >= 1 && a <= 12 && keep<kA0>(e, a); }},
    {0x57, T::kUint8, Since::kAlways, [](V v) { return double(v.module.burn_count); }, nullptr},
    {0x58, T::kUint32, Since::kSetup, [](V v) { return double(v.settings.setup); }, nullptr},
};

// Position, speed, current.
constexpr Parameter kMotion[] = {
    {0x24, T::kInt32, Since::kAlways,
     [](V v) { return inc(v, v.drive.measured_position - v.drive.zero_offset); }, nullptr},
    {0x25, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.data.home.position); }, nullptr},
    {0x28, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.module.target_position); }, nullptr},
    {0x29, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.module.target_speed); },
     [](E e, double i) { return set_target_speed(e, from_increments(e, i)); }},
    {0x2A, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.module.target_acceleration); },
     [](E e, double i) { return set_target_acceleration(e, from_increments(e, i)); }},
    {0x2B, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.module.target_position); }, nullptr},
    {0x35, T::kInt16, Since::kAlways,
     [](V v) { return std::round(v.drive.current / v.data.motor.current_limit * kCurrentDigits); }, nullptr},
    {0x36, T::kInt32, Since::kAlways, [](V v) { return inc(v, position_to_home(v)); }, nullptr},
    {0x3A, T::kUint8, Since::kAlways, [](V v) { return double(v.module.move_mode); }, nullptr},
    {0x3C, T::kFloat, Since::kAlways, [](V v) { return v.drive.measured_position; }, nullptr},
    {0x3D, T::kFloat, Since::kAlways, [](V v) { return v.module.previous_position; }, nullptr},
    {0x3E, T::kFloat, Since::kAlways, [](V v) { return v.drive.setpoint.position; }, nullptr},
    {0x3F, T::kFloat, Since::kAlways, following_error, nullptr},
    {0x41, T::kFloat, Since::kAlways, [](V v) { return v.drive.measured_speed; }, nullptr},
    {0x42, T::kFloat, Since::kAlways, [](V v) { return v.drive.setpoint.speed; }, nullptr},
    {0x4D, T::kFloat, Since::kAlways, [](V v) { return v.drive.current; }, nullptr},
    {0x4E, T::kFloat, Since::kAlways, [](V v) { return v.module.target_position; }, nullptr},
    {0x4F, T::kFloat, Since::kAlways, [](V v) { return v.module.target_speed; }, set_target_speed},
    {0x50, T::kFloat, Since::kAlways, [](V v) { return v.module.target_acceleration; },
     set_target_acceleration},
    {0x5A, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.drive.measured_position); }, nullptr},
    {0x60, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.drive.measured_speed); }, nullptr},
    {0x61, T::kInt32, Since::kAlways, [](V v) { return inc(v, following_error(v)); }, nullptr},
    {0x63, T::kFloat, Since::kCombined, [](V v) { return v.module.saved_position; }, nullptr},
};

// Limits and homing: the factory's value, the one in force, and the same in increments.
constexpr Parameter kLimits[] = {
    {0x00, T::kFloat, Since::kAlways, [](V v) { return v.data.home.position; }, nullptr},
    {0x03, T::kFloat, Since::kAlways, [](V v) { return factory_minimum(v); }, nullptr},
    {0x04, T::kFloat, Since::kAlways, [](V v) { return factory_maximum(v); }, nullptr},
    {0x05, T::kFloat, Since::kAlways, [](V v) { return v.data.limits.following_error; }, nullptr},
    {0x09, T::kFloat, Since::kAlways, no, nullptr},
    {0x0A, T::kFloat, Since::kAlways, [](V v) { return v.data.limits.maximum_speed; }, nullptr},
    {0x0B, T::kFloat, Since::kAlways, no, nullptr},
    {0x0C, T::kFloat, Since::kAlways, [](V v) { return v.data.limits.maximum_acceleration; }, nullptr},
    {0x0D, T::kFloat, Since::kAlways, no, nullptr},
    {0x0E, T::kFloat, Since::kAlways, [](V v) { return v.data.motor.current_limit; }, nullptr},
    {0x0F, T::kFloat, Since::kAlways, [](V v) { return v.data.home.speed; }, nullptr},
    {0x10, T::kFloat, Since::kAlways, [](V v) { return v.data.limits.maximum_acceleration; }, nullptr},
    {0x2C, T::kInt32, Since::kAlways, [](V v) { return inc(v, position_to_home(v)); },
     [](E e, double i) { return set_home_offset(e, from_increments(e, i)); }},
    {0x40, T::kFloat, Since::kAlways, [](V v) { return v.drive.tuning.following_error; },
     set_following_error},
    {0x45, T::kFloat, Since::kAlways, minimum_position, set_minimum_position},
    {0x46, T::kFloat, Since::kAlways, maximum_position, set_maximum_position},
    {0x48, T::kFloat, Since::kAlways, [](V v) { return v.drive.tuning.maximum_speed; }, set_maximum_speed},
    {0x4A, T::kFloat, Since::kAlways, [](V v) { return v.drive.tuning.maximum_acceleration; },
     set_maximum_acceleration},
    {0x4C, T::kFloat, Since::kAlways, [](V v) { return v.drive.tuning.maximum_current; },
     set_maximum_current},
    {0x59, T::kFloat, Since::kAlways, position_to_home, set_home_offset},
    {0x5B, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.drive.tuning.following_error); },
     [](E e, double i) { return set_following_error(e, from_increments(e, i)); }},
    {0x5C, T::kInt32, Since::kAlways, [](V v) { return inc(v, minimum_position(v)); },
     [](E e, double i) { return set_minimum_position(e, from_increments(e, i)); }},
    {0x5D, T::kInt32, Since::kAlways, [](V v) { return inc(v, maximum_position(v)); },
     [](E e, double i) { return set_maximum_position(e, from_increments(e, i)); }},
    {0x5E, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.drive.tuning.maximum_speed); },
     [](E e, double i) { return set_maximum_speed(e, from_increments(e, i)); }},
    {0x5F, T::kInt32, Since::kAlways, [](V v) { return inc(v, v.drive.tuning.maximum_acceleration); },
     [](E e, double i) { return set_maximum_acceleration(e, from_increments(e, i)); }},
    {0x64, T::kFloat, Since::kCombined, [](V v) { return v.drive.tuning.home_speed; }, set_home_speed},
    {0x65, T::kInt32, Since::kCombined, [](V v) { return inc(v, v.drive.tuning.home_speed); },
     [](E e, double i) { return set_home_speed(e, from_increments(e, i)); }},
    {0x78, T::kFloat, Since::kExtended, [](V v) { return v.data.motor.nominal_current; }, nullptr},
    {0x79, T::kFloat, Since::kExtended, [](V v) { return v.drive.tuning.maximum_current; },
     set_maximum_current},
};

// State, supplies, and parameters that are only kept.
constexpr Parameter kOther[] = {
    {0x19, T::kUint32, Since::kAlways, kept<kDefDio>, nullptr},
    {0x26, T::kUint32, Since::kAlways, [](V v) { return double(dio_word(v)); }, set_outputs},
    {0x27, T::kUint32, Since::kAlways, [](V v) { return double(state_word(v)); }, nullptr},
    {0x66, T::kInt16, Since::kSync, kept<kSyncTime>, same<kSyncTime>},
    {0x67, T::kInt32, Since::kLoad, kept<kLoadLimit>, same<kLoadLimit>},
    {0x68, T::kInt32, Since::kLoad, kept<kLoadGradient>, same<kLoadGradient>},
    {0x69, T::kUint16, Since::kLoad, kept<kLoadTime>, same<kLoadTime>},
    {0x6C, T::kInt16, Since::kSync,
     [](V v) { return std::round(v.drive.current / v.data.motor.current_limit * kCurrentDigits); }, nullptr},
    {0x6D, T::kInt16, Since::kSync,
     [](V v) { return std::round(v.drive.tuning.supply_voltage * kVoltDigits); }, nullptr},
    {0x6E, T::kInt16, Since::kSync, [](V v) { return std::round(v.drive.winding * kDegreeDigits); }, nullptr},
    {0x6F, T::kInt16, Since::kSync,
     [](V v) { return std::round(v.data.supply.nominal_voltage * kVoltDigits); }, nullptr},
    {0x70, T::kFloat, Since::kExtended, [](V v) { return v.drive.current; }, nullptr},
    {0x71, T::kFloat, Since::kExtended, [](V v) { return v.drive.tuning.supply_voltage; }, nullptr},
    {0x72, T::kFloat, Since::kExtended, [](V v) { return v.drive.winding; }, nullptr},
    {0x73, T::kFloat, Since::kExtended, [](V v) { return v.data.supply.nominal_voltage; }, nullptr},
    {0x74, T::kFloat, Since::kExtended, kept<kMinLogic>, same<kMinLogic>},
    {0x75, T::kFloat, Since::kExtended, kept<kMaxLogic>, same<kMaxLogic>},
    {0x76, T::kFloat, Since::kExtended, [](V v) { return v.data.supply.minimum_voltage; }, nullptr},
    {0x77, T::kFloat, Since::kExtended, kept<kMaxMotor>, same<kMaxMotor>},
    {0x7A, T::kInt32, Since::kExtended, kept<kLogicUnder>, same<kLogicUnder>},
    {0x7B, T::kInt32, Since::kExtended, kept<kLogicOver>, same<kLogicOver>},
    {0x7C, T::kInt32, Since::kExtended, kept<kMotorUnder>, same<kMotorUnder>},
    {0x7D, T::kInt32, Since::kExtended, kept<kMotorOver>, same<kMotorOver>},
    {0x7E, T::kInt32, Since::kExtended, kept<kNominalOver>, same<kNominalOver>},
    {0x7F, T::kInt32, Since::kExtended, [](V v) { return std::round(v.data.motor.peak_time * 1e3); },
     nullptr},
    {0x80, T::kInt32, Since::kExtended, kept<kKpPwm>, same<kKpPwm>},
    {0x81, T::kFloat, Since::kExtended, [](V v) { return v.drive.tuning.maximum_current; },
     set_maximum_current},
    {0x82, T::kInt32, Since::kExtended, [](V) { return kCurrentDigits; }, nullptr},
};

// All tables as one, sorted by id, for a binary search.
constexpr std::size_t kCount =
    std::size(kMachine) + std::size(kMotion) + std::size(kLimits) + std::size(kOther);

std::array<Parameter, kCount> sorted() {
  std::array<Parameter, kCount> all;
  auto to = all.begin();
  for (const std::span<const Parameter> table :
       {std::span<const Parameter>(kMachine), std::span<const Parameter>(kMotion),
        std::span<const Parameter>(kLimits), std::span<const Parameter>(kOther)})
    to = std::ranges::copy(table, to).out;
  std::ranges::sort(all, {}, &Parameter::id);
  return all;
}

const Parameter* find(std::uint8_t id, std::uint16_t firmware) {
  const auto all = parameters();
  const auto at = std::ranges::lower_bound(all, id, {}, &Parameter::id);
  return at != all.end() && at->id == id && known_to(at->since, firmware) ? &*at : nullptr;
}

std::size_t size_of(T type) {
  if (type == T::kUint8) return 1;
  return type == T::kInt16 || type == T::kUint16 ? 2 : 4;
}

// The integer for `value`; outside of the type's range, the nearest one inside.
template <typename Integer>
Integer clamped(double value) {
  constexpr double kLeast = std::numeric_limits<Integer>::min(), kMost = std::numeric_limits<Integer>::max();
  return static_cast<Integer>(std::clamp(value, kLeast, kMost));
}

void put(Message& message, T type, double value) {
  switch (type) {
    case T::kFloat:
      return put_value(message, static_cast<float>(value));
    case T::kInt32:
      return put_value(message, clamped<std::int32_t>(value));
    case T::kUint32:
      return put_value(message, clamped<std::uint32_t>(value));
    case T::kInt16:
      return put_value(message, clamped<std::int16_t>(value));
    case T::kUint16:
      return put_value(message, clamped<std::uint16_t>(value));
    case T::kUint8:
      return put_value(message, clamped<std::uint8_t>(value));
  }
}

double value_of(const Message& message, T type) {
  switch (type) {
    case T::kFloat:
      return value_at<float>(message, 2);
    case T::kInt32:
      return value_at<std::int32_t>(message, 2);
    case T::kUint32:
      return value_at<std::uint32_t>(message, 2);
    case T::kInt16:
      return value_at<std::int16_t>(message, 2);
    case T::kUint16:
      return value_at<std::uint16_t>(message, 2);
    case T::kUint8:
      return message.data[2];
  }
  return 0.0;
}

// FPosStateDio: position, state and inputs in one answer, which is all that a control loop asks for.
Message position_state_dio(const ModuleView& view) {
  Message answer{command::kGetParameter, kPositionStateDio};
  put_value(answer, static_cast<float>(view.drive.measured_position));
  answer.put(short_state(view));
  answer.put(dio_byte(view));
  return answer;
}

}  // namespace

std::span<const Parameter> parameters() {
  static const auto all = sorted();
  return all;
}

bool known_to(Since since, std::uint16_t firmware) {
  switch (since) {
    case Since::kAlways:
      return true;
    case Since::kCombined:
      return (firmware >= 0x2518 && firmware < 0x3500) || firmware >= 0x3518;
    case Since::kSetup:
      return firmware >= 0x3500;
    case Since::kLoad:
      return firmware >= 0x351A;
    case Since::kSync:
      return firmware >= 0x3602;
    case Since::kExtended:
      return firmware >= 0x4601;
  }
  return false;
}

std::optional<Message> get_parameter(const ModuleView& view, std::uint8_t id) {
  const auto firmware = view.settings.firmware;
  if (id == kPositionStateDio && known_to(Since::kCombined, firmware)) return position_state_dio(view);
  const auto* parameter = find(id, firmware);
  if (!parameter) return std::nullopt;
  Message answer{command::kGetParameter, id};
  put(answer, parameter->type, parameter->get(view));
  return answer;
}

SetResult set_parameter(const ModuleEdit& edit, const Message& message) {
  if (message.size < 2) return SetResult::kRefused;
  const auto* parameter = find(message.data[1], edit.settings.firmware);
  if (!parameter || !parameter->set || message.size != 2 + size_of(parameter->type))
    return SetResult::kRefused;
  const double value = value_of(message, parameter->type);
  if (!std::isfinite(value) || !parameter->set(edit, value)) return SetResult::kRefused;
  return SetResult::kDone;
}

void recalculate_loop(const ModuleEdit& edit) {
  const auto factory = factory_values(edit.data);
  const auto ratio = [&](Kept place) { return edit.module.kept[place] / factory[place]; };
  const auto& loop = edit.data.loop;
  edit.drive.tune(&drive::Tuning::position_gain, loop.position_gain * ratio(kC0));
  edit.drive.tune(&drive::Tuning::velocity_bandwidth, loop.velocity_bandwidth * ratio(kDamp));
  edit.drive.tune(&drive::Tuning::integral_time, loop.integral_time / ratio(kA0));
}

std::array<double, kKept> factory_values(const drive::DriveData& data) {
  std::array<double, kKept> values{};
  values[kC0] = 64, values[kDamp] = 4, values[kA0] = 3;  // libSOC's arm
  values[kMinLogic] = data.supply.minimum_voltage;
  values[kMaxLogic] = values[kMaxMotor] = 27.0;  // V; UPM
  values[kCanBaud] = 2;                          // 500 kbit/s
  values[kRsBaud] = data.linear ? 3 : 5;         // 9600 for grippers, 38400 for the rest
  return values;
}

}  // namespace visum::powercube
