// The ids of the module parameters that the bus group reads and writes, from m5api.
#pragma once

#include <cstdint>

namespace visum::bus_group {

inline constexpr std::uint8_t kSerialNumber = 0x1A, kDefConfig = 0x1B, kVersion = 0x1D, kState = 0x27,
                              kConfig = 0x39, kPosition = 0x3C, kMaxDeltaPos = 0x40, kSpeed = 0x41,
                              kMinPos = 0x45, kMaxPos = 0x46, kMaxVel = 0x48, kMaxAcc = 0x4A, kMaxCur = 0x4C,
                              kCurrent = 0x4D, kTargetSpeed = 0x4F;

}  // namespace visum::bus_group
