// A world that runs: its parts, engines, collisions and sensors, and the cycle that moves them on by one
// tick.
//
// Lives on the tick's thread; the caller owns it. It knows no socket and no thread, and it never waits: the
// loops of server/gateway keep the pace. Everything that changes the world is a call between two ticks, and
// the observer is told of each that was done. Once warm, tick() allocates nothing (FCL and ODE inside do).
//
// The constructor throws where the scene is wrong. Afterwards a request that cannot be done comes back as an
// Outcome and changes nothing. An engine that fails, or a state that explodes, freezes the world at its last
// good state; only reset() or a restore makes it run again.
#pragma once

#include <array>
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
#include "protocol/config/profile.h"
#include "protocol/recording/input.h"
#include "protocol/recording/state.h"
#include "protocol/reset_scope.h"
#include "server/collision/collision.h"
#include "server/cycle/agent_part.h"
#include "server/cycle/body_change.h"
#include "server/cycle/bound_part.h"
#include "server/cycle/machinery.h"
#include "server/cycle/network_model.h"
#include "server/cycle/outcome.h"
#include "server/cycle/phases.h"
#include "server/cycle/pull.h"
#include "server/cycle/scene_change.h"
#include "server/cycle/working.h"
#include "server/dynamics/coupling.h"
#include "server/dynamics/engine.h"
#include "server/scene/scene.h"
#include "server/sensing/senses.h"
#include "server/world/placing.h"
#include "server/world/world_state.h"

namespace visum::powercube {
enum class BusFraming;
}  // namespace visum::powercube

namespace visum::cycle {

// A push of a body that lasts until a tick.
struct Push {
  dynamics::Wrench wrench;
  std::int64_t until_tick = 0;
};

// Hears of everything that changes a world, in order: each input that it took between ticks, and every tick.
// Recorders are observers. The calls come on the tick's thread, which they must not hold up.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void took(const recording::TimedInput& input) = 0;  // after it was done; never for a refused one
  virtual void ticked() = 0;                                  // also after a tick that froze the world
};

class Simulation {
 public:
  // Throws ConfigError where the scene is wrong, and whatever `make` throws.
  explicit Simulation(scene::Scene scene, const PartMaker& make = hwparts::make_part);
  ~Simulation();

  // One pass of the cycle: sense, think, act, collide, step, publish. Does nothing once frozen.
  void tick();

  // The functions from here to restore() are for between ticks. `part` is an index into parts().

  // The caller has checked ports, ranges and Part::refuse().
  void write_inputs(std::size_t part, std::size_t first, std::span<const double> values);
  // The part's controller is gone without a release, or missed its deadline.
  void lose_controller(std::size_t part);
  Outcome set_parameter(std::size_t part, const std::string& name, const protocol::ParameterValue& value);
  Outcome write_blackboard(std::size_t part, std::size_t board, std::uint64_t offset,
                           std::span<const std::byte> data);
  // A telegram from a field bus for the part's modules; the part must have modules. Returns their answer, or
  // nothing where they give none.
  std::optional<powercube::Telegram> handle_telegram(std::size_t part, const powercube::Telegram& telegram,
                                                     powercube::BusFraming framing);

  // Goes back to the scene's beginning, as far as `scope` says, and begins a new era. Not for kSpawned and
  // kAll, which are changes of the bodies (below): reset_now() takes every scope.
  void reset(protocol::ResetScope scope = protocol::ResetScope::kWorld);
  Outcome reset_now(protocol::ResetScope scope);
  // Returns the snapshot's number. Drops the oldest one beyond kMaxSnapshots.
  std::uint64_t take_snapshot();
  // Begins a new era. Refuses with kUnknownName where there is no such snapshot, and with kDamaged where its
  // bytes, which may come from a file, do not fit this world.
  Outcome restore_snapshot(std::uint64_t number);

  // Refuses with kFull where kMaxPushes act already.
  Outcome push(const Push& push);

  // Puts a body elsewhere (nothing: it stays where it is) and gives it a velocity: of its link frame's
  // origin, and its turn rate, both in W. All that hangs on it goes along. A kinematic body keeps that
  // velocity until it is set again. Refuses bodies that cannot be put elsewhere (world/placing.h), numbers
  // beyond 1e6, and a frozen world.
  Outcome set_body(world::BodyId body, const std::optional<world::Pose>& X_WB, const Eigen::Vector3d& v_WB,
                   const Eigen::Vector3d& w_WB);
  // Sets joints, and those that follow them. Their drives go along and stand there until they get a new
  // command.
  Outcome set_joints(std::span<const world::JointPlacement> to);
  // Begins a pull, or changes it. Refuses with kFull where kMaxPulls act already, and where another owner
  // pulls the body.
  Outcome pull(const Pull& pull);
  // False: nobody pulls the body.
  bool release(world::BodyId body);
  void release_all_of(std::uint64_t owner);
  std::span<const Pull> pulls() const { return pulls_; }

  // The caller has checked the fault. Refuses with kFull where FaultSet::kMost act already.
  Outcome inject(const hwparts::ActiveFault& fault);
  // Clears the faults of one part: of all kinds and all drives, unless one is named.
  void clear_faults(std::size_t part, std::optional<hwparts::FaultKind> kind,
                    std::optional<std::size_t> drive);

  // A change of the bodies in three steps (body_change.h): begin_change() or its like here, prepare() on any
  // thread while the world ticks on, and change_bodies() here again. A change is whole or none. It drops the
  // snapshots, which have another number of bodies. Refuses with kWrongState where the bodies have changed
  // since it began, and with kNoMemory where memory runs out.
  BodyChange begin_change(recording::State::Edit edit) const;
  // `given`: what the model is read from, in place of the disk.
  BodyChange begin_spawn(scene::SpawnOrder order, std::optional<config::Files> given = {}) const;
  BodyChange begin_reset(protocol::ResetScope scope) const;  // kSpawned or kAll
  BodyChange begin_restore() const;           // for restore_state(): its `edits` are the state's
  Outcome change_bodies(BodyChange& change);  // afterwards `change` holds the old scene, to be freed
  // The three steps at once. add_body() adds the body of a YAML entry, and refuses what the scene's reader,
  // an engine or a sensor refuses. remove_body() refuses bodies that a model, a joint, a push or a sensor
  // needs. remove_model() takes one that was spawned.
  Outcome add_body(std::string yaml) { return edit_now(Edit::Kind::kBodyCame, std::move(yaml)); }
  Outcome remove_body(std::string name) { return edit_now(Edit::Kind::kBodyWent, std::move(name)); }
  Outcome remove_model(std::string name) { return edit_now(Edit::Kind::kModelWent, std::move(name)); }
  Outcome spawn(scene::SpawnOrder order) { return change_now(begin_spawn(std::move(order))); }
  Outcome spawn(std::shared_ptr<const recording::SpawnedModel> model) {
    return change_now(begin_change({Edit::Kind::kModelCame, {}, std::move(model)}));
  }

  // Another scene in three steps (scene_change.h): begin_load(), prepare() on any thread, and load_scene()
  // here again. It begins a new era at tick 0, with the clock, pace and threads of the scene before. Drops
  // snapshots, faults, pushes, pulls, and all that came. Refuses what engines refuse, and with kNoMemory;
  // then the world goes on as it was.
  SceneChange begin_load(SceneOrder order) const;
  Outcome load_scene(SceneChange& change);  // afterwards `change` holds the old world, to be freed
  // The three steps at once, for a scene that a recording holds.
  Outcome load_scene(std::shared_ptr<const recording::LoadedScene> scene);
  std::uint64_t scene_number() const { return scene_number_; }  // of those that the world has had, from 1

  // Saves the whole world as it is at this tick border. The world must not be frozen.
  void keep(recording::State& whole) const;
  // Restores what keep() saved in a world of the same scene. Checks everything, since it may come from a
  // file. Where it refuses, the world is the scene's initial one. The observer hears nothing: a restored
  // state is no input.
  Outcome restore(const recording::State& whole);

  // The same for a snapshot on disk, as an input, in a new era. Where it refuses, the world is as before.
  // `change`: of begin_restore(), prepared with the state's edits; null: it is made here.
  Outcome restore_state(const recording::State& whole, BodyChange* change = nullptr);
  // True if the bodies and models that came and went are those of the state.
  bool has_bodies_of(const recording::State& whole) const;

  // Adds a part that clients see beside the world's. It is in no snapshot and in no hash. Only before the
  // first tick.
  void add_onlooker(std::unique_ptr<hwparts::Part> part);

  // Null: no observer. It must outlive the simulation, or be taken away before it is destroyed.
  void set_observer(Observer* observer) { observer_ = observer; }
  // One more, which hears after the first: a recording that is started while the world runs.
  void set_second_observer(Observer* observer) { second_observer_ = observer; }

  const scene::Scene& scene() const { return *scene_; }
  const world::WorldModel& model() const { return scene_->world; }
  collision::PreparedMeshes& prepared_meshes() const { return *meshes_; }
  const world::WorldState& state() const { return state_; }
  // The scene's parts, then its sensors, then its agents, then the parts and sensors of each spawned model.
  std::span<BoundPart> parts() { return parts_; }
  std::span<const BoundPart> parts() const { return parts_; }
  std::size_t own_parts() const { return own_parts_; }  // those of the scene, which stand first
  std::span<const collision::Contact> contacts() const { return contacts_; }  // of the last tick, with forces
  std::span<const hwparts::ActiveFault> faults() const { return faults_.all(); }
  std::span<const double> following_errors() const { return following_errors_; }  // by JointId
  // Shared, since a reader on another thread may still hold the old ring when a change of the bodies makes a
  // new one.
  std::shared_ptr<const FlightRing> ring() const { return ring_; }
  const Phases& phases() const { return phases_; }
  // Measures ticks and hashes from now on. Must outlive the simulation, or be taken away by null.
  void set_profile(config::Profile* profile) { profile_ = profile; }
  // For other threads. The texts say which bodies collide, and then for each engine which bodies it moves;
  // they are shared for the reason that ring() is.
  Working& working() { return working_; }
  const Working& working() const { return working_; }
  std::shared_ptr<const std::vector<std::string>> work_texts() const { return work_texts_; }
  std::int64_t tick_count() const { return state_.tick; }
  std::int64_t sim_time_ns() const { return state_.tick * scene_->world.tick_ns; }
  std::uint64_t era() const { return era_; }
  // Ticks since the start in which an engine warned that it missed its tolerance (dynamics::StepResult).
  std::uint64_t solver_warnings() const { return solver_warnings_; }
  // Ticks since the start whose work met a limit, of an engine or of the collisions. Such a tick ended with
  // the best that was reached. The names are those of the bodies that fell short in the last of them, sorted,
  // at most StepResult::kMostNamed.
  std::uint64_t limited_ticks() const { return limited_ticks_; }
  const std::vector<std::string>& limited_bodies() const { return limited_bodies_; }
  std::uint64_t revision() const { return revision_; }  // changes when bodies come or go
  bool frozen() const { return !fault_.empty(); }
  const std::string& fault() const { return fault_; }  // why the world is frozen; empty: it runs
  std::uint64_t state_hash() const;                    // XXH64 over everything that a snapshot holds

  static constexpr std::size_t kMaxSnapshots = 16;
  static constexpr std::size_t kMaxPushes = 64;
  static constexpr std::size_t kMaxPulls = 64;
  // The texts of all bodies that came and are there. Each state in a recording holds them.
  static constexpr std::size_t kMaxEditBytes = std::size_t{16} << 20;

 private:
  // Engines that only the tick's thread may make are left out; they are made when the world is taken.
  enum class EnginesMade { kAll, kThoseOfAnyThread };
  Simulation(scene::Scene scene, const PartMaker& make, EnginesMade engines);
  friend std::unique_ptr<Simulation> make_unstarted(scene::Scene scene, const PartMaker& make);

  struct Snapshot {
    std::uint64_t number;
    world::WorldState state;
    std::vector<std::byte> rest;  // see save_rest()
  };

  // Construction. make_sensors() and make_agents() append to parts_, in that order.
  void make_parts(const PartMaker& make);
  void make_sensors();
  void make_agents();
  void use(Machinery& machinery);
  // Takes a prepared change, or nothing of it. The second and third are its parts that cannot fail.
  Outcome take(BodyChange& change);
  void exchange_state(BodyChange& change);
  void exchange_parts(BodyChange& change);
  // Gives the parts of models that came the numbers that their joints have in the scene.
  void bind_joints(const scene::Scene& scene);
  // Puts everything that belongs to a scene in the place of ours, and ours in its place. Cannot fail.
  void exchange_world(Simulation& other);
  // Puts bodies, joints and ports to the scene's initial state.
  void start_state();
  // The two halves of a reset: without the observer's being told, and of the time alone.
  void take_back(protocol::ResetScope scope);
  void begin_time_anew();
  // Goes back to the scene's own bodies; those that are still there keep their state.
  Outcome reset_bodies(BodyChange& change);
  // Takes a state that was set from outside, unless a number in it is not sane.
  Outcome accept_state(world::WorldState&& changed);
  void add_followers(std::vector<world::JointPlacement>& to) const;
  void place_parts(std::span<const world::JointPlacement> to);
  void save_pulls(hwparts::StateWriter& to) const;
  void load_pulls(hwparts::StateReader& from);
  // Collects the parts' following errors by JointId.
  void follow_parts();
  // After a restore: drops contacts and peaks of the ticks before, which no snapshot holds.
  void forget_ticks();

  // The phases of tick(), in their order.
  void enter(Stage stage) {
    working_.enter(stage, 0, phases_.last());
    if (profile_) profile_->enter(kProfiled[static_cast<std::size_t>(stage)]);
  }
  // The stages of a tick in a profile, in their order.
  static constexpr std::array<config::Profile::Phase, 7> kProfiled{
      config::Profile::kGateway, config::Profile::kParts,     config::Profile::kAgents,
      config::Profile::kDrives,  config::Profile::kCollision, config::Profile::kPhysics,
      config::Profile::kParts};
  void sense();
  void think();
  void act();
  void collide();
  void step();
  // Counts the tick where a limit was met, and takes down the names of these bodies.
  void note_limited(std::vector<world::BodyId>& bodies);
  void publish();
  // Stops the world at before_, its last good state.
  void freeze(std::string fault);

  std::string_view name_of(std::size_t part) const;
  // When an input is taken: some inputs change tick and era, so their functions ask before they act.
  recording::TimedInput now() const { return {state_.tick, era_, {}}; }
  void tell(recording::TimedInput now, const recording::Input& input);

  // Gives each part its own faults and sets its network accordingly.
  void hand_out_faults();
  // Drops the faults whose time is over.
  void end_faults();
  void load_faults(hwparts::StateReader& from);

  // "Rest": all of a snapshot beside the WorldState, which is parts, ports, pushes and faults. load_rest()
  // throws on bytes that do not fit, and leaves the rest half loaded.
  void save_rest(std::vector<std::byte>& bytes) const;
  void load_rest(std::span<const std::byte> bytes);
  // Loads state and rest, or neither.
  Outcome load_all(const world::WorldState& state, std::span<const std::byte> rest);
  void save_all(const world::WorldState& state, std::vector<std::byte>& bytes) const;

  using Edit = recording::State::Edit;
  BodyChange begin(std::shared_ptr<const scene::Scene> base) const;
  Outcome change_now(BodyChange change);
  Outcome edit_now(Edit::Kind kind, std::string text) {
    return change_now(begin_change({kind, std::move(text), nullptr}));
  }
  // Keeps edits_ short: what came and went leaves no entry.
  void note(NotedEdit edit);
  void tell_edit(const Edit& edit);
  static std::size_t bytes_of(const NotedEdit& noted);
  std::size_t edit_bytes() const;
  // Starts from the original scene and applies these edits; throws where one is refused.
  void edit_bodies(const std::vector<Edit>& edits);
  // Takes a change of begin_restore(), or goes back from it; the states of all parts are loaded afterwards.
  Outcome take_restoring(BodyChange& change);
  void take_back_from(BodyChange& change);
  // restore() without its way back: throws where something does not fit, in the middle of the work.
  void restore_all(const recording::State& whole);

  const PartMaker make_;
  // Both are shared with a change of the bodies that is being made ready on another thread.
  std::shared_ptr<collision::PreparedMeshes> meshes_;
  std::shared_ptr<const scene::Scene> scene_;
  std::shared_ptr<const scene::Scene> original_;  // as it was loaded; set once bodies have come or gone
  std::vector<NotedEdit> edits_;                  // from original_ to scene_
  world::WorldState state_;
  world::WorldState before_;      // the last good state, which a frozen world shows
  std::vector<BoundPart> parts_;  // the scene's own, then those of models that came
  std::size_t own_parts_ = 0;     // how many are the scene's own, with the onlooker
  std::size_t first_agent_ = 0;
  std::vector<sensors::Sensor*> sensors_;  // those of parts_, in the scene's order
  std::vector<AgentPart*> agents_;         // those of parts_
  std::vector<std::unique_ptr<dynamics::Engine>> engines_;
  std::unique_ptr<collision::CollisionStage> collision_;
  std::unique_ptr<dynamics::WorldStep> world_step_;
  std::unique_ptr<sensing::Senses> senses_;
  std::vector<collision::Contact> contacts_;
  std::vector<hwparts::JointDrive> drives_;  // by JointId
  std::vector<double> following_errors_;     // by JointId
  std::vector<double> contact_forces_;       // by BodyId
  std::vector<Push> pushes_;
  std::vector<Pull> pulls_;  // sorted by body, one for each
  hwparts::FaultSet faults_;
  std::vector<double> unheard_;  // takes the readings of a silent part
  std::vector<dynamics::Wrench> wrenches_;
  std::vector<Snapshot> snapshots_;
  std::shared_ptr<FlightRing> ring_;
  Phases phases_;
  Working working_;
  config::Profile* profile_ = nullptr;
  std::shared_ptr<const std::vector<std::string>> work_texts_;
  std::uint64_t solver_warnings_ = 0, limited_ticks_ = 0;
  std::vector<std::string> limited_bodies_;
  Observer *observer_ = nullptr, *second_observer_ = nullptr;
  std::uint64_t next_snapshot_ = 1;
  std::uint64_t first_snapshot_ = 1;  // that this scene could have
  std::uint64_t scene_number_ = 1;
  std::uint64_t era_ = 1;
  std::uint64_t revision_ = 1;
  std::string fault_;
  mutable std::vector<std::byte> scratch_;  // for state_hash()
};

// For prepare() of a SceneChange: the world of a scene, but for engines that only the tick's thread may make.
// Throws what the constructor throws.
std::unique_ptr<Simulation> make_unstarted(scene::Scene scene, const PartMaker& make);

}  // namespace visum::cycle
