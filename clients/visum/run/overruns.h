// Judges a run in real time (grade L0): if the host was too slow for the pace, the run is invalid.
#pragma once

#include <string>

#include "protocol/messages.h"

namespace visum::run {

// The share of ticks that may begin more than a tick late. Such a tick is an overrun: the missed time is
// dropped, so the world stays behind its pace for good.
inline constexpr double kMostOverruns = 0.01;

// The reason why a run from `before` to `after` is invalid; empty if it is valid, or the clock was not
// realtime.
std::string why_invalid(const protocol::ServerStatus& before, const protocol::ServerStatus& after,
                        double most_overruns);

}  // namespace visum::run
