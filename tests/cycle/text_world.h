// A world made from the text of a scene.
#pragma once

#include <string>

#include "server/cycle/simulation.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::cycle {

inline scene::Scene scene_of(const std::string& text, const std::string& engine = {}) {
  const test::TempFiles files;
  return scene::load_scene(files.write("scene.yaml", "visum: 1\n" + text), {engine});
}

inline void run(Simulation& world, int ticks) {
  for (int i = 0; i < ticks; ++i) world.tick();
}

inline const world::BodyState& state_of(const Simulation& world, const std::string& body) {
  return world.state().bodies[world.model().find_body(body).index()];
}

}  // namespace visum::cycle
