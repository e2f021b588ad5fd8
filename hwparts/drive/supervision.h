// What a module watches and what stops it: limits, following error, supply, heat, brake; and the three verbs
// Reset, Home, Halt. Every fault latches its bit and ERROR. Two ways to stop:
//   on a ramp, loop closed   Halt, TOW_ERROR, COMM_ERROR, BEYOND_SOFT
//   at once, loop open       BEYOND_HARD and all that switch the power stage off; the brake falls in
// Reset clears what has lost its cause. What the power stage reports (FET_TEMP, INTEGRALERR) needs a power
// cycle first. Pushed beyond a limit, Reset takes ERROR away but leaves BEYOND_... standing until the axis is
// back inside; meanwhile only motion away from the limit is taken, and a target further out is the same fault
// again. A target beyond a soft limit does not lead beyond it.
#pragma once

#include <cstdint>

#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/drive_state.h"

namespace visum::drive {

inline bool has(const DriveState& state, std::uint32_t bits) {  // any of them, latched
  return (state.latched & bits) != 0;
}
// Power on, brake open: the loop moves the rotor.
inline bool ready(const DriveState& state) {
  return state.loop_closed && !state.brake_closed;
}
// The rotor's own position, as far as the encoder tells: limit and reference switches know no zero.
double switch_position(const DriveState& state);

// Compares everything with its limit; latches and stops. Called once per tick, before the setpoint moves.
void supervise(const DriveData& data, DriveState& state);
// Beyond a limit already, what leads further out (`way`, by its sign) trips at once.
void watch_way(DriveState& state, double way);
// How far towards `target` the soft limits let the axis go. With a target beyond one it goes as far as the
// limit, stops there on its ramp and trips. With watch_way() of it.
double reachable_target(const DriveData& data, DriveState& state, double target);
// The brake follows the loop after its release and engage time.
void move_brake(const BrakeData& brake, DriveState& state, double tick_s);
// Switches the power stage off without a fault; the brake falls in. Reset closes the loop again.
void open_loop(DriveState& state);

// Counts when the gear carries more than its rating.
void watch_gear(const GearData& gear, DriveState& state);

// `target`: the one in force now; it is not gone to until another one is given.
void hold(DriveState& state, double target);
void reset(const DriveData& data, DriveState& state, double target);
void halt(DriveState& state, double target);
// Nothing while a fault stands or the loop is open. While the brake opens it waits for that.
void home(DriveState& state);
// Homing is done: home_offset becomes the encoder's zero_offset. Moves nothing.
void set_zero(DriveState& state);
// What was changed about home_offset since it last came into force does. Of what the axis has lost since then
// (a gear that slipped) nothing is found again. Moves nothing.
void apply_home_offset(DriveState& state);

// A field bus says what to do: from now on that holds, until the command's target becomes another one.
void take_from_bus(DriveState& state, const Motion& motion);
// The ports' command holds again.
void release_to_ports(DriveState& state);
void lose_controller(DriveState& state);

// The state word as a module reports it.
std::uint32_t state_word(const DriveState& state);

}  // namespace visum::drive
