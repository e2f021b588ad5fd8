// Reads the settings of a scene file: name, gravity, tick, clock, engines, surfaces. Only keys that are
// present change anything, so the settings of an included file hold until the including file sets them.
#pragma once

#include <span>
#include <string_view>

#include "server/scene/draft.h"

namespace visum::scene {

void read_settings(Draft& draft, const config::Node& root);
void read_engines(Draft& draft, const config::Node& root);
// The keys of the built-in engines. Other kinds of engines ignore them.
std::span<const std::string_view> engine_keys();
void read_surfaces(Draft& draft, const config::Node& root);

}  // namespace visum::scene
