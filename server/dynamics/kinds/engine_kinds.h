// The table of the kinds of engine, by name. It stands in a folder of its own, since it knows every engine
// while no engine knows it. A new engine is a folder in server/dynamics/ and one line in engine_kinds.cc.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "server/dynamics/engine.h"

namespace visum::dynamics {

struct EngineKind {
  const char* name;
  const char* help;
  std::unique_ptr<Engine> (*make)(const world::WorldModel& model, std::int32_t engine_index);
};
std::span<const EngineKind> engine_kinds();

// Throws std::runtime_error, with a text for the user, where the engine's name or settings are wrong.
std::unique_ptr<Engine> make_engine(const world::WorldModel& model, std::int32_t engine_index);

// The processors that this process's hot loops are compiled for: x86-64 or x86-64-v3. Both give the same
// bits. Throws where the environment's VISUM_KERNELS names others.
const char* processor_build();

}  // namespace visum::dynamics
