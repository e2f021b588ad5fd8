// Whether a run in real time (grade L0) was one: a host that is too slow for the pace makes it invalid.
#pragma once

#include <string>

#include "protocol/messages.h"

namespace visum::run {

// Of all ticks, how many may begin more than a tick late. A tick that does is an overrun: what was missed is
// dropped, so that the world is then behind its pace for good.
inline constexpr double kMostOverruns = 0.01;

// Why a run from `before` to `after` is invalid; empty: it is not, or the clock was not realtime.
std::string why_invalid(const protocol::ServerStatus& before, const protocol::ServerStatus& after,
                        double most_overruns);

}  // namespace visum::run
