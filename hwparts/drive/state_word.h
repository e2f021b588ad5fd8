// The bits of the PowerCube state word (parameter 0x27), with the m5api header's names. Bits that this model
// of a servo has no cause for are left out (Hall sensors, a short circuit, the module's own processor).
#pragma once

#include <cstdint>

namespace visum::drive::state_bit {

inline constexpr std::uint32_t kError = 0x00000001;  // any fault: no motion until Reset
inline constexpr std::uint32_t kHomeOk = 0x00000002;
inline constexpr std::uint32_t kHalted = 0x00000004;      // by Halt; only Reset clears it
inline constexpr std::uint32_t kPowerFault = 0x00000008;  // together with one of kPowerStage
inline constexpr std::uint32_t kTowError = 0x00000010;    // following error above its limit
inline constexpr std::uint32_t kCommError = 0x00000020;   // the controller was lost
// The switches as they are now: the reference switch (on just below home), the lower and the upper limit
// switch. hwparts/powercube adds them.
inline constexpr std::uint32_t kSwr = 0x00000040;
inline constexpr std::uint32_t kSw1 = 0x00000080;
inline constexpr std::uint32_t kSw2 = 0x00000100;
inline constexpr std::uint32_t kBrakeActive = 0x00000200;  // brake on, servo loop open
inline constexpr std::uint32_t kCurLimit = 0x00000400;     // warning: current was limited; Reset clears
inline constexpr std::uint32_t kMotion = 0x00000800;
inline constexpr std::uint32_t kRampAcc = 0x00001000;
inline constexpr std::uint32_t kRampSteady = 0x00002000;
inline constexpr std::uint32_t kRampDec = 0x00004000;
inline constexpr std::uint32_t kRampEnd = 0x00008000;      // profile finished, standing
inline constexpr std::uint32_t kInProgress = 0x00010000;   // a step command runs
inline constexpr std::uint32_t kFullBuffer = 0x00020000;   // another one waits
inline constexpr std::uint32_t kPowVoltErr = 0x00040000;   // motor supply too low; Reset after it returned
inline constexpr std::uint32_t kFetTemp = 0x00080000;      // too hot; power cycle, then Reset
inline constexpr std::uint32_t kIntegralErr = 0x00800000;  // I²t used up; power cycle, then Reset
inline constexpr std::uint32_t kBeyondHard = 0x02000000;
inline constexpr std::uint32_t kBeyondSoft = 0x04000000;

inline constexpr std::uint32_t kPowerStage = kPowVoltErr | kFetTemp | kIntegralErr;

}  // namespace visum::drive::state_bit
