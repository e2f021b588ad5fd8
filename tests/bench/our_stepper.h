// Our engines, through the Engine seam, by the names of their rows.
#pragma once

#include "tests/bench/peers/stepper.h"

namespace visum::bench {

bool can_be_made(const world::WorldModel& model);
std::unique_ptr<Stepper> make_our_stepper(const world::WorldModel& model, const std::string& row);

}  // namespace visum::bench
