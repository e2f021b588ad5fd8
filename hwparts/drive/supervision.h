// The supervision inside a module: it watches limits, following error, supply, heat and brake, and it
// carries out Reset, Home and Halt. Pure functions over DriveState; Drive calls them.
//
// Every fault latches its bit and ERROR. A drive stops in one of two ways:
//   on a ramp, loop closed   Halt, TOW_ERROR, COMM_ERROR, BEYOND_SOFT
//   at once, loop open       BEYOND_HARD and every fault that switches the power stage off; the brake falls
//                            in
// Reset clears the faults whose cause is gone. Faults of the power stage (FET_TEMP, INTEGRALERR) need a power
// cycle first. If the axis was pushed beyond a limit, Reset takes ERROR away but leaves BEYOND_... standing
// until the axis is back inside. Until then the drive takes only motion away from the limit, and a target
// further out is the same fault again. A target beyond a soft limit does not lead beyond it.
#pragma once

#include <cstdint>

#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/drive_state.h"

namespace visum::drive {

// True where any of `bits` is latched.
inline bool has(const DriveState& state, std::uint32_t bits) {
  return (state.latched & bits) != 0;
}
// Power on and brake open: the loop moves the rotor.
inline bool ready(const DriveState& state) {
  return state.loop_closed && !state.brake_closed;
}
// The rotor's own position as the encoder measures it, without the zero offset: limit and reference switches
// do not depend on the zero.
double switch_position(const DriveState& state);

// Compares everything with its limit, latches faults and stops. Called once per tick, before the setpoint
// moves.
void supervise(const DriveData& data, DriveState& state);
// Trips at once where the axis is beyond a limit and `way`, by its sign, leads further out.
void watch_way(DriveState& state, double way);
// `target`, or the soft limit before it. An axis with a target beyond a soft limit goes as far as the limit,
// stops there on its ramp, and trips. Calls watch_way() for the way to the target.
double reachable_target(const DriveData& data, DriveState& state, double target);
// The brake follows the loop after its release and engage time.
void move_brake(const BrakeData& brake, DriveState& state, double tick_s);
// Switches the power stage off without a fault; the brake falls in. Reset closes the loop again.
void open_loop(DriveState& state);

// Keeps the gear's peak load, and counts how often it exceeds the rating.
void watch_gear(const GearData& gear, DriveState& state);

// In these three `target` is the ports' target in force now. The drive does not go there until another one is
// given.
void hold(DriveState& state, double target);
void reset(const DriveData& data, DriveState& state, double target);
void halt(DriveState& state, double target);
// Starts homing. Does nothing while a fault stands or the loop is open. While the brake still opens, homing
// waits for it.
void home(DriveState& state);
// The end of homing: home_offset becomes the encoder's zero_offset. Moves nothing.
void set_zero(DriveState& state);
// Puts in force by how much home_offset was changed since it was last in force. If the axis has lost its
// place since (a gear that slipped), this does not find it again. Moves nothing.
void apply_home_offset(DriveState& state);

// A field bus commands `motion`. It holds until the ports' target becomes another one.
void take_from_bus(DriveState& state, const Motion& motion);
// The ports' command holds again.
void release_to_ports(DriveState& state);
// Latches COMM_ERROR; the drive stops on a ramp.
void lose_controller(DriveState& state);

// The state word as a module reports it.
std::uint32_t state_word(const DriveState& state);

}  // namespace visum::drive
