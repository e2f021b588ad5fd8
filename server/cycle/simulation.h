// The world at work: the cycle of the paper's figure 1, one function that reads aloud, and what happens between ticks.
// Knows no socket, no thread and no wall clock: pacing is the loop's (gateway), commands come in as calls between ticks.
// Lives on the tick's thread. tick() does not allocate after warm-up (FCL and ODE inside do; they are counted apart).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hwparts/part.h"
#include "server/collision/collision.h"
#include "server/cycle/flight_ring.h"
#include "server/cycle/phases.h"
#include "server/dynamics/engine.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"

namespace visum::cycle {

// One part bound to its joints, with its two vectors.
struct BoundPart {
  std::unique_ptr<hwparts::Part> part;
  std::vector<world::JointId> joints;         // in the part's order
  std::vector<double> controller_inputs;      // as in force
  std::vector<double> sensor_outputs;
  std::vector<hwparts::JointSample> samples;  // scratch, in the part's order
  std::vector<hwparts::JointDrive> drives;
};

// A push of a body that lasts some ticks.
struct Push {
  world::BodyId body;
  Eigen::Vector3d force_n, torque_nm;  // in W, about the centre of mass
  std::int64_t until_tick;
};

class Simulation {
 public:
  explicit Simulation(scene::Scene scene);  // throws ConfigError
  ~Simulation();

  // One pass of the cycle. Does nothing once frozen.
  void tick();

  // Between ticks.
  void write_inputs(std::size_t part, std::size_t first, std::span<const double> values);  // already checked
  void controller_lost(std::size_t part);
  void reset();                                 // a new era
  std::uint64_t take_snapshot();                // its number; the oldest of kMaxSnapshots is dropped
  bool restore_snapshot(std::uint64_t number);  // a new era; false: no such snapshot
  void push(const Push& push);
  void add_body(const std::string& yaml);        // throws ConfigError and changes nothing
  bool remove_body(const std::string& name);     // false: no such body, or it belongs to a model

  const scene::Scene& scene() const { return scene_; }
  const world::WorldModel& model() const { return scene_.world; }
  const world::WorldState& state() const { return state_; }
  std::span<BoundPart> parts() { return parts_; }
  std::span<const BoundPart> parts() const { return parts_; }
  std::span<const collision::Contact> contacts() const { return contacts_; }  // of the last tick, with forces
  const FlightRing& ring() const { return ring_; }
  const Phases& phases() const { return phases_; }
  std::int64_t tick_count() const { return state_.tick; }
  std::int64_t sim_time_ns() const { return state_.tick * scene_.world.tick_ns; }
  std::uint64_t era() const { return era_; }
  std::uint64_t revision() const { return revision_; }
  bool frozen() const { return !fault_.empty(); }
  const std::string& fault() const { return fault_; }
  // XXH64 over the world's and all parts' saved bytes.
  std::uint64_t state_hash();

  static constexpr std::size_t kMaxSnapshots = 16;
  static constexpr std::size_t kMaxPushes = 64;

 private:
  void sense();
  void act();
  void step();
  void publish();
  void save_all(std::vector<std::byte>& bytes) const;

  scene::Scene scene_;
  world::WorldState state_;
  // ... see simulation.cc
};

}  // namespace visum::cycle
