// The function that each engine's folder provides for the table in kinds/engine_kinds.cc. Each throws
// std::runtime_error for bad settings.
#pragma once

#include <memory>

#include "server/dynamics/engine.h"

namespace visum::dynamics {

std::unique_ptr<Engine> make_impulse_engine(const world::WorldModel& model, std::int32_t engine_index);
std::unique_ptr<Engine> make_ode_engine(const world::WorldModel& model, std::int32_t engine_index);

}  // namespace visum::dynamics
