#include "hwparts/fault_kinds.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "protocol/config/unknown_name.h"

namespace visum::hwparts {
namespace {

constexpr double kMostDrives = 64, kFar = 1e3, kMostEffort = 1e6;
constexpr FaultNumber kJoint{"joint", "", 1.0, kMostDrives, {}};
constexpr FaultNumber kShare{"share", "", 0.0, 1.0, 1.0};

constexpr std::array<FaultInfo, 23> kFaultKinds{{
    {FaultKind::kEncoderStuck,
     "encoder_stuck",
     FaultTarget::kDrive,
     {kJoint},
     "the count stands still, and so do `Actual Angle` and `Actual Speed`; the loop drives on until "
     "TOW_ERROR"},
    {FaultKind::kEncoderOffset,
     "encoder_offset",
     FaultTarget::kDrive,
     {kJoint, FaultNumber{"offset", "<u>", -kFar, kFar, {}}},
     "the count is off by this much; the loop moves the axis there, and no port shows it"},
    {FaultKind::kEncoderNoise,
     "encoder_noise",
     FaultTarget::kDrive,
     {kJoint, FaultNumber{"deviation", "<u>", 0.0, kFar, {}}},
     "each count is off by a random amount, normally distributed"},
    {FaultKind::kTorqueLost,
     "torque_lost",
     FaultTarget::kDrive,
     {kJoint, kShare},
     "this share of the motor's torque is missing, though its current flows"},
    {FaultKind::kBrakeStuck,
     "brake_stuck",
     FaultTarget::kDrive,
     {kJoint, FaultNumber{"closed", "", 0.0, 1.0, 1.0}},
     "the brake stays closed (0: open), whatever the module wants; BRAKEACTIVE shows what it wants"},
    {FaultKind::kGearSlip,
     "gear_slip",
     FaultTarget::kDrive,
     {kJoint, FaultNumber{"effort", "<F>", 0.0, kMostEffort, {}}},
     "above this effort the gear slips; the joint lags behind the encoder until Home finds its place anew"},
    {FaultKind::kOverTemperature,
     "over_temperature",
     FaultTarget::kDrive,
     {kJoint, FaultNumber{"celsius", "°C", -50.0, 500.0, {}}},
     "the winding is at least this hot, above its limit FET_TEMP; afterwards it cools"},
    {FaultKind::kSupplyDip,
     "supply_dip",
     FaultTarget::kSupply,
     {FaultNumber{"volts", "V", 0.0, 60.0, 0.0}},
     "the supply gives at most this voltage; below the drives' minimum POW_VOLT_ERR"},
    {FaultKind::kEmergencyStop,
     "emergency_stop",
     FaultTarget::kSupply,
     {},
     "the emergency stop is pressed: it takes the supply from all motors, POW_VOLT_ERR"},
    {FaultKind::kBusLost,
     "bus_lost",
     FaultTarget::kBus,
     {kShare},
     "this share of the frames to and from the modules is lost"},
    {FaultKind::kBusLate,
     "bus_late",
     FaultTarget::kBus,
     {FaultNumber{"ms", "ms", 0.0, 10'000.0, {}}},
     "each answer of a module comes this much later"},
    {FaultKind::kBusDoubled,
     "bus_doubled",
     FaultTarget::kBus,
     {kShare},
     "this share of the modules' frames comes twice"},
    {FaultKind::kBusCorrupted,
     "bus_corrupted",
     FaultTarget::kBus,
     {kShare},
     "this share of the modules' frames has one bit turned over, so that the checksum is wrong"},
    {FaultKind::kPartSilent,
     "part_silent",
     FaultTarget::kAnyPart,
     {},
     "the part hears nothing and shows nothing new: `Changed` stands still, its drives keep their last "
     "commands"},
    {FaultKind::kNetworkDelay,
     "network_delay",
     FaultTarget::kAnyPart,
     {FaultNumber{"ms", "ms", 0.0, 1000.0, {}}, FaultNumber{"jitter_ms", "ms", 0.0, 1000.0, 0.0}},
     "writes act this much later, and readings are this old; each by up to the jitter more"},
    {FaultKind::kNetworkLoss,
     "network_loss",
     FaultTarget::kAnyPart,
     {kShare},
     "this share of the writes, and of the readings, never arrives"},
    {FaultKind::kSensorOff,
     "sensor_off",
     FaultTarget::kSensor,
     {},
     "the ports stand still, and so does `Changed`"},
    {FaultKind::kSensorFrozen,
     "sensor_frozen",
     FaultTarget::kSensor,
     {},
     "the sensor shows its last reading again and again; `Changed` counts on"},
    {FaultKind::kSensorGarbage,
     "sensor_garbage",
     FaultTarget::kSensor,
     {},
     "the sensor shows random values within its range"},
    {FaultKind::kSensorWrong,
     "sensor_wrong",
     FaultTarget::kSensor,
     {},
     "each value is mirrored in its range, as if the sensor were wired the wrong way round"},
    {FaultKind::kSensorSlow, "sensor_slow", FaultTarget::kSensor, {}, "the sensor shows one reading of ten"},
    {FaultKind::kSensorDelayed,
     "sensor_delayed",
     FaultTarget::kSensor,
     {},
     "readings come ten samples later than usual"},
    {FaultKind::kSensorIntermittent,
     "sensor_intermittent",
     FaultTarget::kSensor,
     {},
     "each reading is lost with a chance of one half"},
}};

std::string in_words(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

// The place of the number with this name.
std::optional<std::size_t> slot_of(const FaultInfo& kind, const std::string& name) {
  for (std::size_t i = 0; i < kMaxNumbers; ++i)
    if (kind.numbers[i] && name == kind.numbers[i]->name) return i;
  return std::nullopt;
}

std::vector<std::string> number_names(const FaultInfo& kind) {
  std::vector<std::string> names;
  for (const auto& number : kind.numbers)
    if (number) names.emplace_back(number->name);
  return names;
}

std::string known_numbers(const FaultInfo& kind) {
  std::string all;
  for (const auto& number : kind.numbers)
    if (number) all += (all.empty() ? "" : ", ") + std::string(number->name);
  return all.empty() ? "it has none" : "it has " + all;
}

std::optional<std::string> refuse(const FaultNumber& number, double value) {
  const std::string name = number.name;
  if (!std::isfinite(value)) return "'" + name + "' must be a finite number";
  if (value < number.minimum || value > number.maximum)
    return "'" + name + "' must be within " + in_words(number.minimum) + " and " + in_words(number.maximum) +
           ", is " + in_words(value);
  if (name == kJoint.name && value != std::floor(value)) return "'joint' is the number of a drive, from 1";
  return std::nullopt;
}

}  // namespace

const char* name_of(FaultTarget target) {
  constexpr std::array<const char*, 5> kNames{"part", "drive", "supply", "bus", "sensor"};
  return kNames[static_cast<std::size_t>(target)];
}

std::span<const FaultInfo> fault_kinds() {
  return kFaultKinds;
}

const FaultInfo& fault_info(FaultKind kind) {
  return kFaultKinds[static_cast<std::size_t>(kind)];
}

bool is_fault_kind(FaultKind kind) {
  return static_cast<std::size_t>(kind) < std::size(kFaultKinds);
}

const FaultInfo* find_fault_kind(std::string_view name) {
  for (const auto& row : kFaultKinds)
    if (name == row.name) return &row;
  return nullptr;
}

std::size_t number_count(const FaultInfo& kind) {
  return static_cast<std::size_t>(
      std::ranges::count_if(kind.numbers, [](const auto& number) { return number.has_value(); }));
}

bool Fault::same_place(const Fault& other) const {
  if (kind != other.kind) return false;
  return fault_info(kind).target != FaultTarget::kDrive || numbers[0] == other.numbers[0];
}

std::string unknown_fault(std::string_view kind) {
  std::vector<std::string> known;
  for (const FaultInfo& row : kFaultKinds) known.emplace_back(row.name);
  const std::string text = config::unknown_name("fault", kind, known);
  return config::nearest(kind, known) ? text : text + "; `visum faults` lists them";
}

std::optional<Fault> make_fault(std::string_view kind, const NamedNumbers& numbers, std::string& why) {
  const auto* found = find_fault_kind(kind);
  if (!found) {
    why = unknown_fault(kind);
    return std::nullopt;
  }
  Fault fault{found->kind, {}};
  std::array<bool, kMaxNumbers> given{};
  for (const auto& [name, value] : numbers) {
    const auto slot = slot_of(*found, name);
    if (!slot)
      why = "'" + std::string(kind) + "' has no number '" + name + "'; " + known_numbers(*found) +
            config::did_you_mean(name, number_names(*found));
    else if (given[*slot])
      why = "'" + name + "' is given twice";
    else if (auto reason = refuse(*found->numbers[*slot], value))
      why = std::move(*reason);
    if (!why.empty()) return std::nullopt;
    fault.numbers[*slot] = value;
    given[*slot] = true;
  }
  for (std::size_t i = 0; i < kMaxNumbers; ++i) {
    if (!found->numbers[i] || given[i]) continue;
    if (!found->numbers[i]->usual) {
      why = "'" + std::string(kind) + "' needs the number '" + found->numbers[i]->name + "'";
      return std::nullopt;
    }
    fault.numbers[i] = *found->numbers[i]->usual;
  }
  return fault;
}

std::optional<Fault> make_fault(const FaultInfo& kind, std::span<const double> numbers, std::string& why) {
  if (numbers.size() != number_count(kind)) {
    why = "'" + std::string(kind.name) + "' has " + std::to_string(number_count(kind)) + " numbers";
    return std::nullopt;
  }
  NamedNumbers named;
  for (std::size_t i = 0; i < numbers.size(); ++i) named.emplace_back(kind.numbers[i]->name, numbers[i]);
  return make_fault(kind.name, named, why);
}

}  // namespace visum::hwparts
