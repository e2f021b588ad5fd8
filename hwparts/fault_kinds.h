// What can be broken on purpose: one table, with what a kind breaks, by which numbers, and how it shows. Who
// is broken (Part::set_faults, the simulation) takes it from there.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace visum::hwparts {

enum class FaultKind : std::uint8_t {
  kEncoderStuck,
  kEncoderOffset,
  kEncoderNoise,
  kTorqueLost,
  kBrakeStuck,
  kGearSlip,
  kOverTemperature,
  kSupplyDip,
  kEmergencyStop,
  kBusLost,
  kBusLate,
  kBusDoubled,
  kBusCorrupted,
  kPartSilent,
  kNetworkDelay,
  kNetworkLoss,
  kSensorOff,
  kSensorFrozen,
  kSensorGarbage,
  kSensorWrong,
  kSensorSlow,
  kSensorDelayed,
  kSensorIntermittent,
};

// Who has what a kind breaks.
enum class FaultTarget : std::uint8_t { kAnyPart, kDrive, kSupply, kBus, kSensor };
const char* name_of(FaultTarget target);

struct FaultNumber {
  const char* name;
  const char* unit;  // "<u>": rad or m, "<F>": N·m or N, as the drive is
  double minimum, maximum;
  std::optional<double> usual;  // where none is given; nothing: one must be
};

inline constexpr std::size_t kMaxNumbers = 3;

struct FaultInfo {
  FaultKind kind;
  const char* name;
  FaultTarget target;
  std::array<std::optional<FaultNumber>, kMaxNumbers> numbers;  // of a drive: first which one, from 1
  const char* effect;
};
std::span<const FaultInfo> fault_kinds();
const FaultInfo* find_fault_kind(std::string_view name);
const FaultInfo& fault_info(FaultKind kind);
bool is_fault_kind(FaultKind kind);  // of a number that came from elsewhere

// One fault, checked against the table.
struct Fault {
  FaultKind kind = FaultKind::kEncoderStuck;
  std::array<double, kMaxNumbers> numbers{};

  // Of a drive: which, from 0.
  std::size_t drive() const { return static_cast<std::size_t>(numbers[0]) - 1; }
  bool same_place(const Fault& other) const;  // one replaces the other
};

// The message for a kind that no row has, with the nearest kind or with where to find them all.
std::string unknown_fault(std::string_view kind);

using NamedNumbers = std::vector<std::pair<std::string, double>>;
// By name; what is not given is usual. Nothing, and why, where there is no such kind, a number of it is
// unknown, missing, not finite, out of its range, or given twice.
std::optional<Fault> make_fault(std::string_view kind, const NamedNumbers& numbers, std::string& why);
// From all numbers of the kind, in their order.
std::optional<Fault> make_fault(const FaultInfo& kind, std::span<const double> numbers, std::string& why);
std::size_t number_count(const FaultInfo& kind);

}  // namespace visum::hwparts
