// Another scene in the place of the world's, made ready beside it.
//
// Reading a scene and making its world can take seconds, and the world need not stand meanwhile.
// Simulation::begin_load() notes between two ticks what shall come. prepare() makes it on any thread.
// Simulation::load_scene() takes it between two later ticks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "protocol/recording/loaded_scene.h"
#include "server/cycle/bound_part.h"
#include "server/cycle/outcome.h"
#include "server/scene/scene.h"

namespace visum::cycle {

class Simulation;

// Names the scene that shall come, and says how it is read.
struct SceneOrder {
  std::filesystem::path file;
  std::string engine;                 // in place of the scene's; empty: the scene's own
  std::optional<std::uint64_t> seed;  // the same
  scene::Packages packages;
};

// A plain value that one thread at a time has.
struct SceneChange {
  SceneChange();
  ~SceneChange();
  SceneChange(SceneChange&&) noexcept;
  SceneChange& operator=(SceneChange&&) noexcept;

  static constexpr std::size_t kMostFileBytes = std::size_t{16} << 20;  // of all files that it is read from
  static constexpr std::size_t kMostParts = 1000;  // parts, sensors and agents of one scene

  SceneOrder order;
  // All that a recording has of it: then the disk is not read, and `order` does not count. Otherwise null
  // until prepare() has noted what it read.
  std::shared_ptr<const recording::LoadedScene> loaded;

  // These are of the world that it began in.
  std::shared_ptr<const scene::Scene> scene;
  PartMaker make;

  // prepare() makes a world of the new scene, which has not ticked. Once it was taken: the old one.
  std::unique_ptr<Simulation> world;
};

// Refuses what the scene's reader, a part or a sensor refuses, with file and line; a scene of another tick,
// with plug-ins, or with too many files or parts; and with kNoMemory what the memory does not suffice for.
// Any thread.
Outcome prepare(SceneChange& change);

}  // namespace visum::cycle
