// The world at work: the cycle of the paper's figure 1, one function that reads aloud, and what happens
// between ticks. Knows no socket and no thread, and waits for nothing: pacing is the loop's (server/gateway),
// commands come in as calls between ticks. Lives on the tick's thread. tick() does not allocate once warm
// (FCL and ODE inside do).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hwparts/fault_set.h"
#include "hwparts/kinds/part_kinds.h"
#include "hwparts/part.h"
#include "hwparts/powercube/message.h"
#include "protocol/recording/input.h"
#include "protocol/recording/state.h"
#include "server/collision/collision.h"
#include "server/cycle/agent_part.h"
#include "server/cycle/flight_ring.h"
#include "server/cycle/network_model.h"
#include "server/cycle/phases.h"
#include "server/dynamics/engine.h"
#include "server/scene/scene.h"
#include "server/sensing/senses.h"
#include "server/world/world_state.h"

namespace visum::powercube {
enum class BusFraming;
}  // namespace visum::powercube

namespace visum::cycle {

// One part bound to its joints, with its two vectors. All spans are in the part's own order.
struct BoundPart {
  std::unique_ptr<hwparts::Part> part;
  std::vector<world::JointId> joints;
  std::vector<double> controller_inputs;  // as in force
  std::vector<double> sensor_outputs;
  std::vector<hwparts::JointSample> samples;
  std::vector<hwparts::JointDrive> drives;
  std::vector<double> following_errors;
  std::string agent;      // of the scene, that commands it; empty: none, clients may
  bool onlooker = false;  // no part of the world's state: see Simulation::add_onlooker

  // What stands between it and its controllers, clients and agents alike: nothing but where a fault is.
  NetworkModel network;
  bool silent = false;
  void hear(std::int64_t tick, std::size_t first, std::span<const double> values);  // a write
  void take(std::size_t first, std::span<const double> values);                     // one that has arrived
  void deliver(std::int64_t until_tick);                     // what has arrived of the writes
  std::vector<double>& readings(std::vector<double>& lost);  // where they go; `lost`: where nobody sees them
  void set_network(const NetworkModel::Quality& quality, std::uint64_t seed);
};

// A push of a body that lasts until a tick.
struct Push {
  dynamics::Wrench wrench;
  std::int64_t until_tick = 0;
};

// Is told of everything that changes a world, in order: what it took between ticks, and every tick. On the
// tick's thread, which it must not hold up.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void took(const recording::TimedInput& input) = 0;  // when it was done; nothing that was refused
  virtual void ticked() = 0;                                  // also by a tick that froze the world
};

// Makes a part from its plan; hwparts::make_part unless parts are to stand in front of something real.
using PartMaker =
    std::function<std::unique_ptr<hwparts::Part>(const std::string& kind, const hwparts::PartContext&)>;

class Simulation {
 public:
  // Throws ConfigError, std::runtime_error from an engine, and what `make` throws.
  explicit Simulation(scene::Scene scene, const PartMaker& make = hwparts::make_part);
  ~Simulation();

  // One pass of the cycle. Does nothing once frozen.
  void tick();

  // Between ticks.
  void write_inputs(std::size_t part, std::size_t first, std::span<const double> values);  // already checked
  void lose_controller(std::size_t part);
  // These return why not; nothing if done.
  std::optional<std::string> set_parameter(std::size_t part, const std::string& name,
                                           const protocol::ParameterValue& value);
  std::optional<std::string> write_blackboard(std::size_t part, std::size_t board, std::uint64_t offset,
                                              std::span<const std::byte> data);
  // A telegram for the part's modules, which it must have.
  std::optional<powercube::Telegram> handle_telegram(std::size_t part, const powercube::Telegram& telegram,
                                                     powercube::BusFraming framing);
  void reset();                   // the scene's initial state, a new era
  std::uint64_t take_snapshot();  // its number; the oldest beyond kMaxSnapshots is dropped
  bool has_snapshot(std::uint64_t number) const;
  // A new era. False, and why: there is no such snapshot, or what it holds (it may come from a file) is none
  // of this world, which is then as it was.
  bool restore_snapshot(std::uint64_t number, std::string* why = nullptr);
  bool push(const Push& push);                     // false: kMaxPushes act already
  bool inject(const hwparts::ActiveFault& fault);  // already checked; false: FaultSet::kMost act already
  void clear_faults(std::size_t part, std::optional<hwparts::FaultKind> kind,
                    std::optional<std::size_t> drive);
  // Throws ConfigError, and what an engine or a sensor has against the world with the body, and changes
  // nothing. Drops the snapshots.
  void add_body(const std::string& yaml);
  std::string remove_body(const std::string& name);  // why not; empty: done. Drops the snapshots.

  // The whole of it at this tick border, and back there, in a world of the same scene: no input, so no
  // observer is told. restore() believes nothing: it returns why not, and then the world is the scene's
  // initial one; empty: done. Not of a frozen world.
  void keep(recording::State& whole) const;
  std::string restore(const recording::State& whole);

  // Another part beside the world's, that its clients see and that is no part of its state: in no snapshot
  // and no hash. Before the first tick.
  void add_onlooker(std::unique_ptr<hwparts::Part> part);

  // From now on; null: nobody. It has to outlive the simulation or be taken away before.
  void set_observer(Observer* observer) { observer_ = observer; }

  const scene::Scene& scene() const { return scene_; }
  const world::WorldModel& model() const { return scene_.world; }
  const world::WorldState& state() const { return state_; }
  // The scene's parts, then its sensors, then its agents.
  std::span<BoundPart> parts() { return parts_; }
  std::span<const BoundPart> parts() const { return parts_; }
  std::span<const collision::Contact> contacts() const { return contacts_; }  // of the last tick, with forces
  std::span<const hwparts::ActiveFault> faults() const { return faults_.all(); }
  std::span<const double> following_errors() const { return following_errors_; }  // by JointId
  // Shared with readers on another thread, who may still hold it when a change of the world makes a new one.
  std::shared_ptr<const FlightRing> ring() const { return ring_; }
  const Phases& phases() const { return phases_; }
  std::int64_t tick_count() const { return state_.tick; }
  std::int64_t sim_time_ns() const { return state_.tick * scene_.world.tick_ns; }
  std::uint64_t era() const { return era_; }
  // Ticks in which an engine fell short of what it was set to (dynamics::StepResult), since the start.
  std::uint64_t solver_warnings() const { return solver_warnings_; }
  std::uint64_t revision() const { return revision_; }  // changes when bodies come or go
  bool frozen() const { return !fault_.empty(); }
  const std::string& fault() const { return fault_; }
  std::uint64_t state_hash() const;  // XXH64 over all that a snapshot holds

  static constexpr std::size_t kMaxSnapshots = 16;
  static constexpr std::size_t kMaxPushes = 64;

 private:
  struct Snapshot {
    std::uint64_t number;
    world::WorldState state;
    std::vector<std::byte> rest;  // parts, their inputs, pushes
  };

  // What is made of the scene, and anew when bodies come or go. Refers to it.
  struct Machinery {
    std::vector<std::unique_ptr<dynamics::Engine>> engines;
    std::unique_ptr<collision::CollisionStage> collision;
    std::unique_ptr<sensing::Senses> senses;
    std::shared_ptr<FlightRing> ring;
    std::vector<hwparts::JointDrive> drives;
    std::vector<double> following_errors, contact_forces;
  };

  void make_parts(const PartMaker& make);
  void make_sensors();
  void make_agents();
  Machinery make_machinery() const;
  void use(Machinery machinery);
  void change_scene(scene::Scene changed, world::BodyId gone = {});  // `gone`: it had it, the new one has not
  void start_state();
  void follow_parts();
  void forget_ticks();
  void sense();
  void think();
  void act();
  void collide();
  void step();
  void publish();
  void freeze(std::string fault);
  std::string_view name_of(std::size_t part) const;
  // Tells the observer of what was taken when the world stood at `now`.
  recording::TimedInput now() const { return {state_.tick, era_, {}}; }
  void tell(recording::TimedInput now, const recording::Input& input);
  void hand_out_faults();
  void end_faults();
  void load_faults(hwparts::StateReader& from);
  void save_rest(std::vector<std::byte>& bytes) const;
  void load_rest(std::span<const std::byte> bytes);
  std::string load_all(const world::WorldState& state, std::span<const std::byte> rest);
  void save_all(const world::WorldState& state, std::vector<std::byte>& bytes) const;
  void note_removed(const std::string& name);
  void edit_bodies(const std::vector<recording::State::Edit>& edits);
  void restore_all(const recording::State& whole);

  scene::Scene scene_;
  std::optional<scene::Scene> original_;       // as it was loaded, once bodies came or went
  std::vector<recording::State::Edit> edits_;  // without bodies that came and went
  std::vector<std::string> edited_;            // beside edits_: the body that came; empty: one went
  world::WorldState state_;
  world::WorldState before_;  // the last good state: what a frozen world shows
  std::vector<BoundPart> parts_;
  std::vector<sensors::Sensor*> sensors_;  // those of parts_
  std::vector<AgentPart*> agents_;         // likewise
  std::vector<std::unique_ptr<dynamics::Engine>> engines_;
  std::unique_ptr<collision::CollisionStage> collision_;
  std::unique_ptr<sensing::Senses> senses_;
  std::vector<collision::Contact> contacts_;
  std::vector<hwparts::JointDrive> drives_;  // by JointId
  std::vector<double> following_errors_;     // by JointId
  std::vector<double> contact_forces_;       // by BodyId
  std::vector<Push> pushes_;
  hwparts::FaultSet faults_;
  std::vector<double> unheard_;  // what a silent part would show
  std::vector<dynamics::Wrench> wrenches_;
  std::vector<Snapshot> snapshots_;
  std::shared_ptr<FlightRing> ring_;
  Phases phases_;
  std::uint64_t solver_warnings_ = 0;
  Observer* observer_ = nullptr;
  std::uint64_t next_snapshot_ = 1;
  std::uint64_t era_ = 1;
  std::uint64_t revision_ = 1;
  std::string fault_;
  mutable std::vector<std::byte> scratch_;  // for state_hash()
};

}  // namespace visum::cycle
