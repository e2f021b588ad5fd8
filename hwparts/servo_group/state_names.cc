#include "hwparts/servo_group/state_names.h"

#include <array>
#include <bit>
#include <utility>

#include "hwparts/drive/state_word.h"
#include "hwparts/servo_group/part_state.h"

namespace visum::servo_group {
namespace {

namespace state_bit = drive::state_bit;

constexpr std::array<std::pair<std::uint32_t, const char*>, 23> kBits{{
    {state_bit::kError, "ERROR"},
    {state_bit::kHomeOk, "HOME_OK"},
    {state_bit::kHalted, "HALTED"},
    {state_bit::kPowerFault, "POWERFAULT"},
    {state_bit::kTowError, "TOW_ERROR"},
    {state_bit::kCommError, "COMM_ERROR"},
    {state_bit::kSwr, "SWR"},
    {state_bit::kSw1, "SW1"},
    {state_bit::kSw2, "SW2"},
    {state_bit::kBrakeActive, "BRAKEACTIVE"},
    {state_bit::kCurLimit, "CURLIMIT"},
    {state_bit::kMotion, "MOTION"},
    {state_bit::kRampAcc, "RAMP_ACC"},
    {state_bit::kRampSteady, "RAMP_STEADY"},
    {state_bit::kRampDec, "RAMP_DEC"},
    {state_bit::kRampEnd, "RAMP_END"},
    {state_bit::kInProgress, "INPROGRESS"},
    {state_bit::kFullBuffer, "FULLBUFFER"},
    {state_bit::kPowVoltErr, "POW_VOLT_ERR"},
    {state_bit::kFetTemp, "FET_TEMP"},
    {state_bit::kIntegralErr, "INTEGRALERR"},
    {state_bit::kBeyondHard, "BEYOND_HARD"},
    {state_bit::kBeyondSoft, "BEYOND_SOFT"},
}};

constexpr std::array<std::pair<PartState, const char*>, 8> kStates{{
    {PartState::kReady, "ready"},
    {PartState::kMoving, "moving"},
    {PartState::kDisabled, "disabled"},
    {PartState::kNotHomed, "not homed"},
    {PartState::kHalted, "halted"},
    {PartState::kFault, "fault"},
    {PartState::kControllerLost, "controller lost"},
    {PartState::kHoming, "homing"},
}};

}  // namespace

std::vector<protocol::NumberName> module_state_bits() {
  std::vector<protocol::NumberName> names;
  for (const auto& [bit, name] : kBits) names.push_back({std::countr_zero(bit), name});
  return names;
}

std::vector<protocol::NumberName> part_state_names() {
  std::vector<protocol::NumberName> names;
  for (const auto& [state, name] : kStates) names.push_back({static_cast<std::int64_t>(state), name});
  return names;
}

}  // namespace visum::servo_group
