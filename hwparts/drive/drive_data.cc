#include "hwparts/drive/drive_data.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "hwparts/drive/friction.h"
#include "hwparts/drive/motor.h"
#include "hwparts/drive/servo_classes.h"
#include "protocol/config/unknown_name.h"

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

constexpr std::array<Field<GearData>, 11> kGear{{
    {"rotor_inertia_kg_m2", &GearData::rotor_inertia},
    {"viscous_friction_<F>_s_per_<u>", &GearData::viscous_friction, kNonNegative},
    {"coulomb_friction_<F>", &GearData::coulomb_friction, kNonNegative},
    {"coulomb_speed_<u>_per_s", &GearData::coulomb_speed},
    {"dry_friction_<F>", &GearData::dry_friction, kNonNegative, 0.0},
    {"static_friction_<F>", &GearData::static_friction, kNonNegative, 0.0},
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

constexpr std::array<Field<LoopData>, 5> kLoop{{
    {"position_gain_per_s", &LoopData::position_gain},
    {"velocity_bandwidth_per_s", &LoopData::velocity_bandwidth},
    {"integral_time_s", &LoopData::integral_time, kNonNegative},
    {"speed_filter_s", &LoopData::speed_filter, kNonNegative},
    {"period_s", &LoopData::period, kPositive, 0.0},
}};

constexpr std::array<Field<HomeData>, 2> kHome{{
    {"position_<u>", &HomeData::position, kAny},
    {"speed_<u>_per_s", &HomeData::speed},
}};

constexpr std::array<Field<SupplyData>, 2> kSupply{{
    {"nominal_voltage_v", &SupplyData::nominal_voltage, {0.0, kHighestSupply_v, true}},
    {"minimum_voltage_v", &SupplyData::minimum_voltage, {0.0, kHighestSupply_v, true}},
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

// Reads the sections of one entry. Where the entry has a servo class, the data that it starts from hold for
// every key that is left out. Otherwise such a key is noted, and all of them are told together.
class EntryReader {
 public:
  EntryReader(const Node& entry, const DriveData& from, bool has_class)
      : entry_(entry), data_(from), has_class_(has_class) {}

  // The section `name` of the entry, with these keys and `others`. Nothing if it is left out.
  template <typename Section, std::size_t n>
  std::optional<Node> section(const char* name, const std::array<Field<Section>, n>& fields, Section& section,
                              const std::vector<std::string>& others = {}) {
    const auto node = entry_.find(name);
    auto keys = keys_of(std::span<const Field<Section>>(fields), data_.linear);
    keys.insert(keys.end(), others.begin(), others.end());
    if (node) allow(*node, keys);
    read(node, name, fields, section);
    return node;
  }
  template <typename Section, std::size_t n>
  void read(const std::optional<Node>& node, const char* name, const std::array<Field<Section>, n>& fields,
            Section& section) {
    for (const auto& field : fields) {
      const std::string key = spell(field.key, data_.linear);
      const bool given = node && node->find(key);
      if (given) section.*field.member = node->get(key).number(field.range);
      if (given || has_class_) continue;
      if (field.otherwise)
        section.*field.member = *field.otherwise;
      else
        missing_.push_back(std::string(name) + "." + key);
    }
  }
  // A pair [smaller, larger] of the section `limits`.
  void range(const std::optional<Node>& node, const std::string& key, double& minimum, double& maximum) {
    const auto given = node ? node->find(key) : std::nullopt;
    if (!given) {
      if (!has_class_) missing_.push_back("limits." + key);
      return;
    }
    const auto values = given->numbers(2);
    if (values[0] >= values[1]) given->fail("must be [smaller, larger]");
    minimum = values[0];
    maximum = values[1];
  }
  void text(const char* key, std::string& to) {
    if (const auto given = entry_.find(key))
      to = given->text();
    else if (!has_class_)
      missing_.emplace_back(key);
  }
  void module(int& to) {
    if (const auto given = entry_.find("module"))
      to = static_cast<int>(given->integer(1, 31));
    else if (!has_class_)
      missing_.emplace_back("module");
    else if (to > 31)
      entry_.fail("a bus has 31 modules; this drive is number " + std::to_string(to) + " in the file");
  }

  void fail_if_missing() const {
    if (missing_.empty()) return;
    std::string all;
    for (const auto& key : missing_) all += (all.empty() ? "" : ", ") + key;
    std::string classes;
    for (const auto& name : servo_class_names()) classes += (classes.empty() ? "" : " or ") + name;
    entry_.fail("missing: " + all + "; `servo: " + classes + "` gives all that is left out");
  }
  DriveData& data() { return data_; }
  bool has_class() const { return has_class_; }

 private:
  const Node& entry_;
  DriveData data_;
  bool has_class_;
  std::vector<std::string> missing_;
};

// The place of a value for an error: the key where it is given, else the nearest thing around it.
Node place_of(const Node& entry, const char* section, const std::string& key) {
  const auto node = entry.find(section);
  if (!node) return entry;
  return node->find(key).value_or(*node);
}

void read_gear(EntryReader& reader) {
  DriveData& data = reader.data();
  const auto& ratio = data.linear ? kLinearRatio : kRotaryRatio;
  const auto node = reader.section("gear", kGear, data.gear, {ratio[0].key});
  reader.read(node, "gear", ratio, data.gear);
  const bool names_static = node && node->find(spell("static_friction_<F>", data.linear));
  if (!names_static) data.gear.static_friction = data.gear.dry_friction;
}

void read_limits(const Node& entry, EntryReader& reader) {
  DriveData& data = reader.data();
  LimitData& limits = data.limits;
  const std::string soft = spell("soft_<u>", data.linear), hard = spell("hard_<u>", data.linear);
  const auto node = reader.section("limits", kLimits, limits, {soft, hard});
  // Only a rotary drive can turn forever.
  const bool given = node && (node->find(soft) || node->find(hard));
  limits.limited = limits.limited || data.linear || given;
  if (!limits.limited) return;
  reader.range(node, soft, limits.soft_minimum, limits.soft_maximum);
  reader.range(node, hard, limits.hard_minimum, limits.hard_maximum);
  if (reader.has_class() && limits.hard_minimum >= limits.hard_maximum)
    entry.fail("the model gives no stops: name limits." + soft + " and limits." + hard);
}

// A drive that is commanded by its speed has no place to go home to.
void read_home(const Node& entry, EntryReader& reader) {
  DriveData& data = reader.data();
  if (!data.speed_controlled) {
    reader.section("home", kHome, data.home);
    return;
  }
  if (const auto node = entry.find("home")) node->fail("means nothing for a drive with 'control: velocity'");
  data.home.speed = data.limits.maximum_speed;
}

void check_motor(const Node& entry, const MotorData& motor) {
  if (motor.nominal_current > motor.current_limit)
    place_of(entry, "motor", "nominal_current_a").fail("is above current_limit_a");
  if (motor.maximum_winding <= motor.ambient)
    place_of(entry, "motor", "maximum_winding_c").fail("must be above ambient_c");
}

// `most_effort` [F] is what the motor gives at its current limit.
void check_gear(const Node& entry, const GearData& gear, double most_effort, bool linear) {
  const bool rigid = gear.stiffness == 0.0;
  if (rigid && (gear.backlash > 0.0 || gear.damping > 0.0)) {
    place_of(entry, "gear", "")
        .fail("backlash and damping belong to an elastic gear: give " +
              spell("stiffness_<F>_per_<u>", linear));
  }
  if (gear.breaking_effort < gear.peak_effort)
    place_of(entry, "gear", spell("breaking_<T>_<F>", linear)).fail("is below the rated peak");
  const std::string holds = spell("static_friction_<F>", linear);
  if (gear.static_friction < gear.dry_friction)
    place_of(entry, "gear", holds).fail("is below " + spell("dry_friction_<F>", linear));
  if (gear.static_friction > 0.0 && gear.static_friction >= most_effort)
    place_of(entry, "gear", holds)
        .fail("the motor never moves: it gives at most " + std::to_string(most_effort));
}

void check_limits(const Node& entry, const LimitData& limits, bool linear) {
  if (!limits.limited) return;
  if (limits.soft_minimum < limits.hard_minimum || limits.soft_maximum > limits.hard_maximum)
    place_of(entry, "limits", spell("soft_<u>", linear)).fail("reaches beyond " + spell("hard_<u>", linear));
}

void check_home(const Node& entry, const DriveData& data) {
  if (data.speed_controlled) return;
  const Node node = entry.find("home").value_or(entry);
  if (data.home.speed > data.limits.maximum_speed) node.fail("the speed is above limits' speed");
  const auto& limits = data.limits;
  if (limits.limited &&
      (data.home.position < limits.soft_minimum || data.home.position > limits.soft_maximum)) {
    node.fail("the position is outside of the soft limits");
  }
}

void check_supply(const Node& entry, const SupplyData& supply) {
  if (supply.minimum_voltage > supply.nominal_voltage)
    place_of(entry, "supply", "minimum_voltage_v").fail("is above nominal_voltage_v");
}

// Figures from different sources may contradict each other. This refuses a drive that cannot reach the
// maximum speed that its file promises.
void check_speed(const Node& node, const DriveData& data) {
  const double speed = data.limits.maximum_speed;
  const auto window = current_window(data, data.supply.nominal_voltage, speed);
  const double friction = friction_effort(data.gear, speed) + data.gear.dry_friction;
  if (friction < data.effort_per_amp() * window.upper) return;
  node.fail("the motor cannot reach the maximum speed: friction there takes " + std::to_string(friction) +
            " of the " + std::to_string(std::max(0.0, data.effort_per_amp() * window.upper)) +
            " that it can give at that speed");
}

// The servo class' figures, behind the gear ratio that the entry gives; nothing but zeros without a class.
DriveData starting_data(const Node& entry, bool linear, const JointBounds& joint) {
  DriveData data;
  data.linear = linear;
  const auto named = entry.find("servo");
  if (!named) return data;
  const ServoClass* servo = find_servo_class(named->text());
  if (!servo) named->fail(config::unknown_name("servo class", named->text(), servo_class_names()));
  double ratio = default_ratio(*servo, linear, joint);
  if (const auto gear = entry.find("gear"))
    ratio = gear->number_or(linear ? kLinearRatio[0].key : kRotaryRatio[0].key, ratio, kPositive);
  return class_defaults(*servo, ratio, linear, joint);
}

void read_brake(const Node& entry, bool linear, BrakeData& brake) {
  const auto node = entry.find("brake");
  brake.present = node.has_value();
  if (!node) return;
  allow(*node, keys_of(std::span<const Field<BrakeData>>(kBrake), linear));
  for (const auto& field : kBrake)
    brake.*field.member = node->get(spell(field.key, linear)).number(field.range);
}

}  // namespace

double DriveData::increment() const {
  return 2.0 * std::numbers::pi / (encoder.increments_per_turn * gear.ratio);
}

DriveData read_drive_data(const Node& entry, bool linear, const JointBounds& joint) {
  entry.allow_only({"joints", "servo", "module", "type", "control", "motor", "gear", "encoder", "brake",
                    "limits", "loop", "home", "supply"});
  EntryReader reader(entry, starting_data(entry, linear, joint), entry.find("servo").has_value());
  DriveData& data = reader.data();
  reader.text("type", data.type);
  reader.module(data.module);
  if (const auto control = entry.find("control"))
    data.speed_controlled = control->one_of({"position", "velocity"}) == "velocity";
  reader.section("motor", kMotor, data.motor);
  read_gear(reader);
  reader.section("encoder", kEncoder, data.encoder);
  read_brake(entry, linear, data.brake);
  read_limits(entry, reader);
  reader.section("loop", kLoop, data.loop);
  read_home(entry, reader);
  reader.section("supply", kSupply, data.supply);
  reader.fail_if_missing();
  check_motor(entry, data.motor);
  check_gear(entry, data.gear, data.effort_per_amp() * data.motor.current_limit, linear);
  check_limits(entry, data.limits, linear);
  check_supply(entry, data.supply);
  check_home(entry, data);
  check_speed(entry.find("limits").value_or(entry), data);
  return data;
}

}  // namespace visum::drive
