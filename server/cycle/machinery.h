// All that a world is moved by and that is made from its scene: made anew when bodies come or go.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hwparts/joint.h"
#include "hwparts/sensors/sensor.h"
#include "server/collision/collision.h"
#include "server/cycle/flight_ring.h"
#include "server/dynamics/engine.h"
#include "server/dynamics/world_step.h"
#include "server/scene/scene.h"
#include "server/sensing/senses.h"
#include "server/world/placing.h"

namespace visum::cycle {

// Refers to the scene that it was made from, which must outlive it. The Simulation owns the one in use.
struct Machinery {
  std::vector<std::unique_ptr<dynamics::Engine>> engines;
  std::unique_ptr<collision::CollisionStage> collision;
  std::unique_ptr<dynamics::WorldStep> world_step;
  std::unique_ptr<sensing::Senses> senses;
  std::shared_ptr<FlightRing> ring;
  std::shared_ptr<const std::vector<std::string>> work_texts;  // Simulation::work_texts()
  std::vector<hwparts::JointDrive> drives;                     // by JointId
  std::vector<double> following_errors, contact_forces;        // by JointId; by BodyId
};

// Makes everything but the engines. Any thread, also while the sensors are in use: they are not changed.
// Throws where the scene is wrong (config::ConfigError, std::runtime_error).
Machinery make_machinery(const scene::Scene& scene, std::span<sensors::Sensor* const> sensors,
                         collision::PreparedMeshes& meshes);

// True if any thread may make the engines: those of plug-ins, and ODE, are made on the tick's thread.
bool may_make_engines(const scene::Scene& scene);

// On the tick's thread, unless may_make_engines(). Quick beside make_machinery(), which builds the trees
// of meshes. Throws ConfigError where an engine does not exist or does not take the scene.
std::vector<std::unique_ptr<dynamics::Engine>> make_engines(const scene::Scene& scene);

}  // namespace visum::cycle
