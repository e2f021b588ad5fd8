// Models that come into a world that runs, with their parts, drives and sensors.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "server/scene/draft.h"

namespace visum::scene {

inline constexpr std::size_t kMaxSpawned = 256;         // models that came and are there
inline constexpr std::size_t kMaxSpawnedBodies = 1000;  // of one of them
inline constexpr std::size_t kMaxSpawnedParts = 256;    // parts and sensors, of all of them together

struct SpawnOrder {
  std::filesystem::path file;  // a robot's file, or one of the scene format
  std::string name;            // empty: the file's
  world::Pose X_WM;            // where its origin stands
  bool make_unique = false;    // a name that is taken gets a number
};

// Reads the model and appends it to the scene, whose last entry of `spawned` then says what came. A robot's
// file is placed as read_bare_model() places it, without a floor. A file of the scene format gets the name as
// its parameter `name`; it may bring models, bodies, joints, parts and sensors, and surfaces and materials,
// but no settings and nothing that is about what was there before. Throws ConfigError, and leaves the scene
// half changed then: work on a copy.
void spawn(Scene& scene, const SpawnOrder& order);

// True if the file of the scene format can be spawned under any name: it has a parameter `name`.
bool can_be_spawned(const config::Node& root);

// Reads a file of the scene format into a draft of a spawned model.
void read_spawned_file(Draft& draft, const std::filesystem::path& file,
                       const std::optional<config::Node>& parameters);

}  // namespace visum::scene
