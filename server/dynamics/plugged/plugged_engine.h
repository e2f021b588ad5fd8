// An engine whose kind comes from a plug-in (protocol/plugin/plugin.h), behind the Engine seam. If it throws
// or leaves bad numbers, its step fails with a text. What it saves is its memory in WorldState.
#pragma once

#include <memory>

#include "protocol/config/config.h"
#include "protocol/plugin/plugin.h"
#include "server/dynamics/engine.h"

namespace visum::dynamics {

// `entry`: the engine's entry in the scene, a map; `resting`: keys of other kinds, which mean nothing here.
// Throws ConfigError for mistakes in the entry, and for what the plug-in refuses.
std::unique_ptr<Engine> make_plugged_engine(const plugin::EngineKind& kind, const world::WorldModel& model,
                                            std::int32_t engine_index, const config::Node& entry,
                                            std::vector<std::string> resting);

}  // namespace visum::dynamics
