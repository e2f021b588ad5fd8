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

const char* name_of(Failure failure) {
  return kNames[static_cast<std::size_t>(failure)].name;
}

}  // namespace visum::sensors
