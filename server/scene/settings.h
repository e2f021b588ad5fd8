// The settings of a scene file: name, gravity, tick, clock, engines, surfaces. Only keys that are present
// change anything, so that the settings of an included file hold until the including file says otherwise.
#pragma once

#include <span>
#include <string_view>

#include "server/scene/draft.h"

namespace visum::scene {

void read_settings(Draft& draft, const config::Node& root);
void read_engines(Draft& draft, const config::Node& root);
// What engines that are built in know; beside another kind they rest.
std::span<const std::string_view> engine_keys();
void read_surfaces(Draft& draft, const config::Node& root);

}  // namespace visum::scene
