#include "hwparts/drive/drive_data.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "hwparts/drive/friction.h"
#include "hwparts/drive/motor.h"

namespace visum::drive {
namespace {

using config::kNonNegative;
using config::kPositive;
using config::Node;
using config::Range;

constexpr Range kAny{};

// One number of a section. In the key, <u> stands for "rad" or "m", <F> for "nm" or "n", <T> for "torque" or
// "force".
template <typename Section>
struct Field {
  const char* key;
  double Section::*member;
  Range range = kPositive;
  std::optional<double> otherwise = std::nullopt;  // nothing: the key is required
};

constexpr std::array<Field<MotorData>, 9> kMotor{{
    {"torque_constant_nm_per_a", &MotorData::torque_constant},
    {"resistance_ohm", &MotorData::resistance},
    {"current_limit_a", &MotorData::current_limit},
    {"nominal_current_a", &MotorData::nominal_current},
    {"peak_time_s", &MotorData::peak_time},
    {"thermal_resistance_k_per_w", &MotorData::thermal_resistance},
    {"thermal_time_s", &MotorData::thermal_time},
    {"ambient_c", &MotorData::ambient, kAny},
    {"maximum_winding_c", &MotorData::maximum_winding, kAny},
}};

constexpr std::array<Field<GearData>, 9> kGear{{
    {"rotor_inertia_kg_m2", &GearData::rotor_inertia},
    {"viscous_friction_<F>_s_per_<u>", &GearData::viscous_friction, kNonNegative},
    {"coulomb_friction_<F>", &GearData::coulomb_friction, kNonNegative},
    {"coulomb_speed_<u>_per_s", &GearData::coulomb_speed},
    {"stiffness_<F>_per_<u>", &GearData::stiffness, kPositive, 0.0},
    {"damping_<F>_s_per_<u>", &GearData::damping, kNonNegative, 0.0},
    {"backlash_<u>", &GearData::backlash, kNonNegative, 0.0},
    {"peak_<T>_<F>", &GearData::peak_effort},
    {"breaking_<T>_<F>", &GearData::breaking_effort},
}};
constexpr std::array<Field<GearData>, 1> kRotaryRatio{{{"ratio", &GearData::ratio}}};
constexpr std::array<Field<GearData>, 1> kLinearRatio{{{"ratio_rad_per_m", &GearData::ratio}}};

constexpr std::array<Field<EncoderData>, 1> kEncoder{{
    {"increments_per_turn", &EncoderData::increments_per_turn},
}};

constexpr std::array<Field<BrakeData>, 3> kBrake{{
    {"holding_<T>_<F>", &BrakeData::holding_effort},
    {"release_time_s", &BrakeData::release_time, kNonNegative},
    {"engage_time_s", &BrakeData::engage_time, kNonNegative},
}};

constexpr std::array<Field<LimitData>, 5> kLimits{{
    {"speed_<u>_per_s", &LimitData::maximum_speed},
    {"acceleration_<u>_per_s2", &LimitData::maximum_acceleration},
    {"stop_deceleration_<u>_per_s2", &LimitData::stop_deceleration},
    {"following_error_<u>", &LimitData::following_error},
    {"tolerance_<u>", &LimitData::tolerance, kNonNegative},
}};

constexpr std::array<Field<LoopData>, 4> kLoop{{
    {"position_gain_per_s", &LoopData::position_gain},
    {"velocity_bandwidth_per_s", &LoopData::velocity_bandwidth},
    {"integral_time_s", &LoopData::integral_time, kNonNegative},
    {"speed_filter_s", &LoopData::speed_filter, kNonNegative},
}};

constexpr std::array<Field<HomeData>, 2> kHome{{
    {"position_<u>", &HomeData::position, kAny},
    {"speed_<u>_per_s", &HomeData::speed},
}};

constexpr std::array<Field<SupplyData>, 2> kSupply{{
    {"nominal_voltage_v", &SupplyData::nominal_voltage},
    {"minimum_voltage_v", &SupplyData::minimum_voltage},
}};

std::string spell(std::string key, bool linear) {
  const std::array<std::array<const char*, 3>, 3> words{
      {{"<u>", "rad", "m"}, {"<F>", "nm", "n"}, {"<T>", "torque", "force"}}};
  for (const auto& word : words) {
    for (auto at = key.find(word[0]); at != std::string::npos; at = key.find(word[0])) {
      key.replace(at, 3, word[linear ? 2 : 1]);
    }
  }
  return key;
}

// The keys of `fields` as they stand in the file.
template <typename Section>
std::vector<std::string> keys_of(std::span<const Field<Section>> fields, bool linear) {
  std::vector<std::string> keys;
  for (const auto& field : fields) keys.push_back(spell(field.key, linear));
  return keys;
}

void allow(const Node& node, const std::vector<std::string>& keys) {
  node.allow_only({keys.begin(), keys.end()});
}

template <typename Section>
void read_fields(const Node& node, std::span<const Field<Section>> fields, bool linear, Section& section) {
  for (const auto& field : fields) {
    const std::string key = spell(field.key, linear);
    section.*field.member = field.otherwise ? node.number_or(key, *field.otherwise, field.range)
                                            : node.get(key).number(field.range);
  }
}

template <typename Section, std::size_t n>
void read_section(const Node& node, const std::array<Field<Section>, n>& fields, bool linear,
                  Section& section) {
  allow(node, keys_of(std::span<const Field<Section>>(fields), linear));
  read_fields(node, std::span<const Field<Section>>(fields), linear, section);
}

void read_motor(const Node& node, bool linear, MotorData& motor) {
  read_section(node, kMotor, linear, motor);
  if (motor.nominal_current > motor.current_limit) {
    node.get("nominal_current_a").fail("is above current_limit_a");
  }
  if (motor.maximum_winding <= motor.ambient) node.get("maximum_winding_c").fail("must be above ambient_c");
}

void read_gear(const Node& node, bool linear, GearData& gear) {
  const auto& ratio = linear ? kLinearRatio : kRotaryRatio;
  auto keys = keys_of(std::span<const Field<GearData>>(kGear), linear);
  keys.emplace_back(ratio[0].key);
  allow(node, keys);
  read_fields(node, std::span<const Field<GearData>>(kGear), linear, gear);
  read_fields(node, std::span<const Field<GearData>>(ratio), linear, gear);
  const bool rigid = gear.stiffness == 0.0;
  if (rigid && (gear.backlash > 0.0 || gear.damping > 0.0)) {
    node.fail("backlash and damping belong to an elastic gear: give " +
              spell("stiffness_<F>_per_<u>", linear));
  }
  if (gear.breaking_effort < gear.peak_effort) {
    node.get(spell("breaking_<T>_<F>", linear)).fail("is below the rated peak");
  }
}

void read_range(const Node& node, const std::string& key, double& minimum, double& maximum) {
  const auto values = node.get(key).numbers(2);
  if (values[0] >= values[1]) node.get(key).fail("must be [smaller, larger]");
  minimum = values[0];
  maximum = values[1];
}

void read_limits(const Node& node, bool linear, LimitData& limits) {
  const std::string soft = spell("soft_<u>", linear), hard = spell("hard_<u>", linear);
  auto keys = keys_of(std::span<const Field<LimitData>>(kLimits), linear);
  keys.push_back(soft);
  keys.push_back(hard);
  allow(node, keys);
  read_fields(node, std::span<const Field<LimitData>>(kLimits), linear, limits);
  limits.limited = linear || node.find(soft) || node.find(hard);  // only a rotary drive can turn forever
  if (!limits.limited) return;
  read_range(node, soft, limits.soft_minimum, limits.soft_maximum);
  read_range(node, hard, limits.hard_minimum, limits.hard_maximum);
  if (limits.soft_minimum < limits.hard_minimum || limits.soft_maximum > limits.hard_maximum) {
    node.get(soft).fail("reaches beyond " + hard);
  }
}

void read_brake(const Node& entry, bool linear, BrakeData& brake) {
  const auto node = entry.find("brake");
  brake.present = node.has_value();
  if (node) read_section(*node, kBrake, linear, brake);
}

// A drive that is commanded by its speed has no place to go home to.
void read_home(const Node& entry, DriveData& data) {
  if (data.speed_controlled) {
    if (const auto node = entry.find("home"))
      node->fail("means nothing for a drive with 'control: velocity'");
    data.home.speed = data.limits.maximum_speed;
    return;
  }
  const Node node = entry.get("home");
  read_section(node, kHome, data.linear, data.home);
  if (data.home.speed > data.limits.maximum_speed) node.fail("the speed is above limits' speed");
  const auto& limits = data.limits;
  if (limits.limited &&
      (data.home.position < limits.soft_minimum || data.home.position > limits.soft_maximum)) {
    node.fail("the position is outside of the soft limits");
  }
}

// Figures from different sources may contradict each other. This refuses a drive that cannot reach the
// maximum speed that its file promises.
void check_speed(const Node& node, const DriveData& data) {
  const double speed = data.limits.maximum_speed;
  const auto window = current_window(data, data.supply.nominal_voltage, speed);
  const double friction = friction_effort(data.gear, speed);
  if (friction < data.effort_per_amp() * window.upper) return;
  node.fail("the motor cannot reach the maximum speed: friction there takes " + std::to_string(friction) +
            " of the " + std::to_string(std::max(0.0, data.effort_per_amp() * window.upper)) +
            " that it can give at that speed");
}

}  // namespace

double DriveData::increment() const {
  return 2.0 * std::numbers::pi / (encoder.increments_per_turn * gear.ratio);
}

DriveData read_drive_data(const Node& entry, bool linear) {
  entry.allow_only({"joints", "module", "type", "control", "motor", "gear", "encoder", "brake", "limits",
                    "loop", "home", "supply"});
  DriveData data;
  data.linear = linear;
  data.type = entry.get("type").text();
  data.module = static_cast<int>(entry.get("module").integer(1, 31));
  if (const auto control = entry.find("control"))
    data.speed_controlled = control->one_of({"position", "velocity"}) == "velocity";
  read_motor(entry.get("motor"), linear, data.motor);
  read_gear(entry.get("gear"), linear, data.gear);
  read_section(entry.get("encoder"), kEncoder, linear, data.encoder);
  read_brake(entry, linear, data.brake);
  read_limits(entry.get("limits"), linear, data.limits);
  read_section(entry.get("loop"), kLoop, linear, data.loop);
  read_section(entry.get("supply"), kSupply, linear, data.supply);
  if (data.supply.minimum_voltage > data.supply.nominal_voltage) {
    entry.get("supply").get("minimum_voltage_v").fail("is above nominal_voltage_v");
  }
  read_home(entry, data);
  check_speed(entry.get("limits"), data);
  return data;
}

}  // namespace visum::drive
