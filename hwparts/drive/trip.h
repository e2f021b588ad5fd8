// The figures at the moment when a drive tripped, and what they mean in words. They are for people: no state
// of the drive, so no snapshot holds them. Pure functions.
#pragma once

#include <cstdint>
#include <string>

#include "hwparts/drive/drive_state.h"

namespace visum::drive {

struct Trip {
  std::uint32_t bits = 0;  // the faults (state_word.h); 0: none
  double lag = 0.0;        // [u], setpoint minus measured position
  double position = 0.0;   // [u], measured
  double target = 0.0;     // [u], of the ports
  double i2t = 0.0;        // A²s
  double rest_s = 0.0;     // without current, until it has lessened enough for Reset
  double winding = 0.0;    // °C
  Tuning tuning;           // limits and supply as they were
};

// The faults among the latched bits that are not in `known`.
std::uint32_t new_faults(std::uint32_t latched, std::uint32_t known);
// The state before it is supervised, when the reasons still show.
Trip figures_of(const DriveState& state);
// "following error 0.31 rad exceeds 0.3 rad; move slower, ...": each fault with its numbers, and what to try.
std::string trip_text(const DriveData& data, const Trip& trip);

}  // namespace visum::drive
