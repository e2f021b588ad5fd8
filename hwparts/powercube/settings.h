// The settings of a part's modules: their identities, and their behaviour where the published sources leave
// it open. In a scene they are the part's key `modules:`; every key in it is optional.
//
//   modules:
//     firmware: 0x4634          # or 0x3521; see below
//     beyond_limits: clamp
//     each:                     # exceptions, by module id
//       8: {firmware: 0x3521, serial_number: 20278}
//
// Firmware 0x3521 has an incremental encoder, and its module must be homed. Firmware 0x4634 has an absolute
// one, and its module comes up with HOME_OK. Care-O-bot's driver tells the two apart by just these numbers.
// By default a part that starts homed has 0x4634, and a part that does not has 0x3521.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "hwparts/drive/drive_data.h"
#include "protocol/config/config.h"

namespace visum::powercube {

// The bits of the configuration word (parameter 0x39) that change a module's behaviour here. Other bits are
// kept.
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
inline constexpr std::uint32_t kDisableAck = 0x04000000;    // CAN only; GET is still answered
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
  // The sources leave these open; the defaults are guesses.
  // kStop: with a target outside, the axis goes up to the limit and trips BEYOND_SOFT there.
  BeyondLimits beyond_limits = BeyondLimits::kStop;
  // For a step more than the queue holds. kAdvance: it cuts the running step short. kReplace: it takes the
  // place of the queued one.
  ThirdStep third_step = ThirdStep::kAdvance;
  AboveMaximum above_maximum = AboveMaximum::kClamp;  // for a parameter beyond the factory's limit
  bool answers_refused = true;  // answers a refused command, with `refused_byte` in place of 64 (hex)
  std::uint8_t refused_byte = 0x00;
  bool serial_broadcasts = true;  // reacts to module id 0 on RS-232
  double watchdog_s = 0.2;
  double state_period_s = 0.01;  // SYNC_TRANSMIT: the state is sent with this period, and when it changes
};

// The settings of one module of the part `part`. Throws ConfigError.
Settings read_settings(const config::Node& part, const drive::DriveData& data, bool part_homed);

// The serial number that `modules: each:` gives to a module, if it gives one. Throws ConfigError.
std::optional<std::uint32_t> stated_serial_number(const config::Node& part, int module);

// Refuses exceptions for modules that the part does not have. Throws ConfigError.
void check_exceptions(const config::Node& part, std::span<const int> modules);

}  // namespace visum::powercube
