// A world with sensors from a few lines of a scene, and their ports by name.
#pragma once

#include <stdexcept>
#include <string>

#include "server/cycle/simulation.h"
#include "tests/support/temp_files.h"

namespace visum::sensing::test {

inline scene::Scene scene_of(const std::string& yaml) {
  const visum::test::TempFiles files;
  return scene::load_scene(files.write("world.yaml", "visum: 1\n" + yaml));
}

struct WorldBench {
  explicit WorldBench(const std::string& yaml) : simulation(scene_of(yaml)) {}

  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) simulation.tick();
    if (simulation.frozen()) throw std::runtime_error(simulation.fault());
  }
  const cycle::BoundPart& part(const std::string& name) const {
    for (const auto& bound : simulation.parts())
      if (bound.part->description().name == name) return bound;
    throw std::runtime_error("no part " + name);
  }
  double port(const std::string& name, const std::string& port) const {
    const auto& bound = part(name);
    const auto& ports = bound.part->description().sensor_outputs;
    for (std::size_t i = 0; i < ports.size(); ++i)
      if (ports[i].name == port) return bound.sensor_outputs[i];
    throw std::runtime_error("no port " + port);
  }
  Eigen::Vector3d axes(const std::string& name, const std::string& quantity) const {
    return {port(name, quantity + " X"), port(name, quantity + " Y"), port(name, quantity + " Z")};
  }

  cycle::Simulation simulation;
};

}  // namespace visum::sensing::test
