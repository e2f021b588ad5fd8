// The faults that can be caused on purpose: one table with each kind's target, numbers and effect. Parts
// (Part::set_faults) and the simulation give each kind its effect. Plain values and pure functions.
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

// The thing that a kind breaks. A part says by Part::has() whether it has such a thing.
enum class FaultTarget : std::uint8_t { kAnyPart, kDrive, kSupply, kBus, kSensor };
const char* name_of(FaultTarget target);

struct FaultNumber {
  const char* name;
  const char* unit;  // "<u>": rad or m, "<F>": N·m or N, for a rotary or a linear drive
  double minimum, maximum;
  std::optional<double> usual;  // the default; nothing: the number must be given
};

inline constexpr std::size_t kMaxNumbers = 3;

struct FaultInfo {
  FaultKind kind;
  const char* name;
  FaultTarget target;
  std::array<std::optional<FaultNumber>, kMaxNumbers>
      numbers;  // for a drive, the first is its number, from 1
  const char* effect;
};
std::span<const FaultInfo> fault_kinds();
const FaultInfo* find_fault_kind(std::string_view name);
const FaultInfo& fault_info(FaultKind kind);
bool is_fault_kind(FaultKind kind);  // for a number that was read from a snapshot or recording

// One fault, checked against the table.
struct Fault {
  FaultKind kind = FaultKind::kEncoderStuck;
  std::array<double, kMaxNumbers> numbers{};

  // The drive of a drive's fault, counted from 0.
  std::size_t drive() const { return static_cast<std::size_t>(numbers[0]) - 1; }
  bool same_place(const Fault& other) const;  // true: each replaces the other
};

// The message for a kind that no row has, with the nearest kind or with where to find them all.
std::string unknown_fault(std::string_view kind);

using NamedNumbers = std::vector<std::pair<std::string, double>>;
// Makes a fault from named numbers; those not given take their default. Returns nothing, and says `why`, for
// an unknown kind, and for a number that is unknown, missing, not finite, out of its range, or given twice.
std::optional<Fault> make_fault(std::string_view kind, const NamedNumbers& numbers, std::string& why);
// The same from all numbers of the kind, in their order.
std::optional<Fault> make_fault(const FaultInfo& kind, std::span<const double> numbers, std::string& why);
std::size_t number_count(const FaultInfo& kind);

}  // namespace visum::hwparts
