// Reads the sections `materials:`, `lights:`, `viewpoints:` and `panels:`. Throws ConfigError.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

void read_materials(Draft& draft, const config::Node& root);
void read_light(Draft& draft, const config::Node& node);
void read_viewpoint(Draft& draft, const config::Node& node);
void read_panel(Draft& draft, const config::Node& node);

}  // namespace visum::scene
