// A scene around a single model file: a floor below it, and a part for its joints.
#pragma once

#include <filesystem>
#include <string>

#include "server/scene/draft.h"

namespace visum::scene {

// True for the extensions of models: .urdf, .sdf, .world, .xacro, .mjcf and .xml, in small or capital
// letters.
bool is_model_file(const std::filesystem::path& file);

// Reads a model, which stands fixed at the origin unless it is MJCF, and puts a floor below its lowest point,
// but not above the origin. Its joints that can be driven become a part of the kind `ideal_joints`; of MJCF,
// those with an actuator, if there are any. Model and part have the file's name. Links that overlap at the
// start never collide. With springs or screws, engine `impulse` moves it. Throws ConfigError.
// Of an SDF file with a <world>, each model becomes one of the scene, with its own name, place and part. The
// world's gravity and step act, and no floor is added.
void read_bare_model(Draft& draft, const std::filesystem::path& file);

// Places the one model of a file, with a part for its joints, under this name. Fails at the file where it
// holds several.
void place_bare_model(Draft& draft, const std::filesystem::path& file, const std::string& name);

// The file's name as a name of the scene.
std::string name_of_model_file(const std::filesystem::path& file);

}  // namespace visum::scene
