#include "hwparts/sensors/failure.h"

#include <array>

namespace visum::sensors {
namespace {

constexpr std::array<FailureName, 8> kNames{{
    {Failure::kOk, "ok"},
    {Failure::kOff, "off"},
    {Failure::kStuck, "stuck"},
    {Failure::kGarbage, "garbage"},
    {Failure::kWrong, "wrong"},
    {Failure::kSlow, "slow"},
    {Failure::kDelayed, "delayed"},
    {Failure::kIntermittent, "intermittent"},
}};

}  // namespace

std::span<const FailureName> failure_names() {
  return kNames;
}

Failure failure_of(hwparts::FaultKind kind) {
  using hwparts::FaultKind;
  switch (kind) {
    case FaultKind::kSensorOff:
      return Failure::kOff;
    case FaultKind::kSensorFrozen:
      return Failure::kStuck;
    case FaultKind::kSensorGarbage:
      return Failure::kGarbage;
    case FaultKind::kSensorWrong:
      return Failure::kWrong;
    case FaultKind::kSensorSlow:
      return Failure::kSlow;
    case FaultKind::kSensorDelayed:
      return Failure::kDelayed;
    case FaultKind::kSensorIntermittent:
      return Failure::kIntermittent;
    default:
      return Failure::kOk;
  }
}

bool is_failure(Failure failure) {
  return static_cast<std::size_t>(failure) < std::size(kNames);
}

const char* name_of(Failure failure) {
  return kNames[static_cast<std::size_t>(failure)].name;
}

}  // namespace visum::sensors
