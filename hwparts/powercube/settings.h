// What is set about the modules of a part: who they say they are, and how they behave where the published
// sources leave it open. In a scene, `modules:` of the part; every key is optional.
//
//   modules:
//     firmware: 0x4634          # or 0x3521; see below
//     beyond_limits: clamp
//     each:                     # exceptions, by module id
//       8: {firmware: 0x3521, serial_number: 20278}
//
// Firmware 0x3521 with an incremental encoder is a module that must be homed; 0x4634 with an absolute one
// comes up with HOME_OK (Care-O-bot's driver tells the two apart by just these numbers). Unless set, a part
// that starts homed has the latter and one that does not the former.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "hwparts/drive/drive_data.h"
#include "protocol/config/config.h"

namespace visum::powercube {

// Bits of the configuration word (parameter 39) that change what a module here does; others are kept.
namespace config_bit {
inline constexpr std::uint32_t kBrakePresent = 0x00000008;
inline constexpr std::uint32_t kSwrEnabled = 0x00000100;
inline constexpr std::uint32_t kSw1Enabled = 0x00000800;
inline constexpr std::uint32_t kSw2Enabled = 0x00004000;
inline constexpr std::uint32_t kLinear = 0x00020000;
inline constexpr std::uint32_t kAllowFullCurrent = 0x00080000;
inline constexpr std::uint32_t kM3Compatible = 0x00100000;  // no motion unless homed
inline constexpr std::uint32_t kDisableOnHalt = 0x00800000;
inline constexpr std::uint32_t kWatchdogEnable = 0x01000000;
inline constexpr std::uint32_t kZeroMoveAfterHome = 0x02000000;
inline constexpr std::uint32_t kDisableAck = 0x04000000;    // CAN only; GET is answered
inline constexpr std::uint32_t kSyncMotion = 0x08000000;    // CAN only
inline constexpr std::uint32_t kSyncTransmit = 0x10000000;  // firmware 0x36.. and later
}  // namespace config_bit

inline constexpr std::uint16_t kIncremental = 0x3521;
inline constexpr std::uint16_t kAbsolute = 0x4634;

enum class BeyondLimits { kStop, kClamp, kRefuse };
enum class ThirdStep { kAdvance, kReplace, kRefuse };
enum class AboveMaximum { kClamp, kRefuse };

struct Settings {
  std::uint16_t firmware = kAbsolute;
  std::uint32_t setup = 0;
  std::uint32_t config = 0;  // DefConfig
  std::uint32_t serial_number = 0;
  bool homed = true;              // at start
  bool counts_from_zero = false;  // not homed: the encoder starts at 0, wherever the axis is
  // Open in the sources; the defaults are guesses.
  BeyondLimits beyond_limits =
      BeyondLimits::kStop;                     // a target outside: up to the limit, and BEYOND_SOFT there
  ThirdStep third_step = ThirdStep::kAdvance;  // one more than the queue holds: cuts the running one
                                               // short, or takes the place of the one that waits
  AboveMaximum above_maximum = AboveMaximum::kClamp;  // a parameter beyond the factory's limit
  bool answers_refused = true;                        // refused commands, with `refused_byte` for 64
  std::uint8_t refused_byte = 0x00;
  bool serial_broadcasts = true;  // reacts to module id 0 on RS-232
  double watchdog_s = 0.2;
  double state_period_s = 0.01;  // SYNC_TRANSMIT: the state is sent so often, and when it changes
};

// The settings of one module of the part `part`. Throws ConfigError.
Settings read_settings(const config::Node& part, const drive::DriveData& data, bool part_homed);

// The serial number that `modules: each:` gives to a module; none: it says nothing. Throws ConfigError.
std::optional<std::uint32_t> stated_serial_number(const config::Node& part, int module);

// Refuses exceptions for modules that the part does not have. Throws ConfigError.
void check_exceptions(const config::Node& part, std::span<const int> modules);

}  // namespace visum::powercube
