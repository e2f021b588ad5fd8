// The changing state of one servo. A plain value: everything that decides the future is here, so saving it
// saves the drive. Only Drive and the functions of this folder write it. Units as in drive_data.h.
#pragma once

#include <array>
#include <cstdint>

#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/motion.h"
#include "hwparts/drive/ramp.h"
#include "hwparts/state_archive.h"

namespace visum::drive {

// The settings that may be changed while the drive runs. They start as the data say.
struct Tuning {
  double position_gain = 0.0;         // 1/s
  double velocity_bandwidth = 0.0;    // 1/s
  double integral_time = 0.0;         // s; 0: none
  double maximum_acceleration = 0.0;  // [u]/s²
  double following_error = 0.0;       // [u]
  double soft_minimum = 0.0;          // [u]
  double soft_maximum = 0.0;
  double supply_voltage = 0.0;  // V
  // Only a field bus changes these.
  double maximum_speed = 0.0;      // [u]/s
  double maximum_current = 0.0;    // A
  double home_speed = 0.0;         // [u]/s
  double brake_engage_time = 0.0;  // s
};

// Kept from one run of a loop with a period of its own to the next.
struct LoopSample {
  std::uint32_t age = 0;        // ticks since it ran
  double travel = 0.0;          // [u], as the encoder has seen it since the speed was measured
  double wanted_current = 0.0;  // A, what it asks for
};

struct DriveState {
  // Mechanics: the rotor in the module's coordinate. The joints hang on it by the gear's spring.
  double rotor_position = 0.0;
  double rotor_speed = 0.0;
  std::array<double, kMaxJointsPerDrive> joint_position{};  // as last published
  double gear_effort = 0.0;                                 // [F], transmitted during the last tick

  // The module's knowledge. Its positions are the rotor's plus zero_offset.
  double zero_offset = 0.0;        // [u], whole increments; arbitrary while `referenced` is false
  double home_offset = 0.0;        // [u], becomes zero_offset with the next homing
  double offset_in_force = 0.0;    // [u], the home_offset that zero_offset was made with
  bool referenced = true;          // false: not homed yet, so the soft limits mean nothing
  double measured_position = 0.0;  // whole increments
  double measured_speed = 0.0;     // filtered difference
  Setpoint setpoint;
  double integral_current = 0.0;  // A, the velocity loop's integral part
  double current = 0.0;           // A, during the last tick
  LoopSample loop;

  // Heat.
  double i2t = 0.0;      // A²s
  double winding = 0.0;  // °C

  // Modes.
  std::uint32_t latched = 0;  // bits of the state word that stay until something clears them
  bool loop_closed = true;
  bool brake_closed = false;
  double brake_time = 0.0;  // s since the loop opened or closed
  bool homing = false;
  bool zero_after_home = false;  // homing ends with a move to 0
  bool moves_to_zero = false;    // the move to 0 runs now
  bool power_cycled = false;     // the supply was off since the last fault of the power stage
  bool holding = false;          // stands until the command's target differs from hold_target
  double hold_target = 0.0;
  // The ports' target as last latched. Halt, Reset and bus commands come between ticks and hold against it
  // (hold_target), so it must survive a restore that no write follows: that is why the drive keeps its own
  // copy of this controller input, and why a snapshot holds it.
  double commanded = 0.0;
  bool by_bus = false;  // a field bus commanded last: holds until the command's target becomes another one
  Motion motion;        // the bus' command
  std::int8_t soft_side = 0;  // -1, +1: beyond that soft limit, and known to be
  std::int8_t hard_side = 0;

  // The gear's load since the last Reset.
  double peak_effort = 0.0;     // [F]
  std::uint64_t overloads = 0;  // how often the rating was exceeded
  bool overloaded = false;

  Tuning tuning;
};

Tuning initial_tuning(const DriveData& data);
// At rest at `position`, powered, with the loop closed.
DriveState initial_state(const DriveData& data, double position, bool homed);

// Without `loop`, which only a loop with a period of its own needs.
void save(const DriveState& state, hwparts::StateWriter& to);
void load(DriveState& state, hwparts::StateReader& from);
void save(const LoopSample& loop, hwparts::StateWriter& to);
void load(LoopSample& loop, hwparts::StateReader& from);

}  // namespace visum::drive
