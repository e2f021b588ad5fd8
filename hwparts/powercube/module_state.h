// The changing state of a module apart from its drive: settings that came over the bus, and its memory. A
// plain value: saving it and the drive saves the module. [u] is rad or m.
#pragma once

#include <array>
#include <cstdint>

#include "hwparts/drive/drive.h"
#include "hwparts/powercube/settings.h"
#include "hwparts/state_archive.h"

namespace visum::powercube {

// The number of parameters that are only kept. Their names and factory values are in parameters.cc.
inline constexpr std::size_t kKept = 19;

struct ModuleState {
  std::uint8_t address = 0;
  std::uint32_t config = 0;
  double target_speed = 0.0;         // [u]/s, for ramps; every Reset sets it back to the maximum
  double target_acceleration = 0.0;  // [u]/s²
  double target_position = 0.0;      // [u], of the last ramp or step
  std::uint8_t move_mode = 0;        // mode byte of the last SETMOVE
  double previous_position = 0.0;    // [u], a tick ago
  double saved_position = 0.0;       // [u], by SAVEPOS
  std::uint8_t outputs = 0;          // bits 4..7 of the digital outputs
  std::uint8_t burn_count = 1;
  bool deferred = false;  // SYNC_MOTION: the motion below waits for its start
  drive::Motion deferred_motion;
  bool watchdog_armed = false;
  double watchdog_s = 0.0;       // since the last life sign
  double state_s = 0.0;          // since the last state frame
  std::uint32_t state_sent = 0;  // the state word in that frame
  std::array<double, kKept> kept{};
};

ModuleState initial_state(const Settings& settings, const drive::DriveData& data, double position);
void save(const ModuleState& state, hwparts::StateWriter& to);
void load(ModuleState& state, hwparts::StateReader& from);

// One whole module, for reading.
struct ModuleView {
  const Settings& settings;
  const drive::DriveData& data;
  const drive::DriveState& drive;
  const ModuleState& module;
  bool enabled;  // the part's Execution Enable
};
// One whole module, for carrying out commands: the drive through its own commands, the rest directly.
struct ModuleEdit {
  const Settings& settings;
  const drive::DriveData& data;
  drive::Drive& drive;
  ModuleState& module;
  bool enabled;
  operator ModuleView() const { return {settings, data, drive.state(), module, enabled}; }
};

// The state word (parameter 0x27): the drive's bits, and the switches that the configuration enables. The
// reference switch is on just below home, the limit switches beyond the hard limits.
std::uint32_t state_word(const ModuleView& view);
// The state byte of extended answers: NOT_OK, switches, and the phase of the motion.
std::uint8_t short_state(const ModuleView& view);
// Inputs in bits 0..3 (not wired: always 0), outputs in 4..7.
std::uint8_t dio_byte(const ModuleView& view);
std::uint32_t dio_word(const ModuleView& view);

// Conversion between [u] and the module's increments.
std::int32_t to_increments(const ModuleView& view, double value);
double from_increments(const ModuleView& view, double increments);

}  // namespace visum::powercube
