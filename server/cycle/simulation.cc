#include "server/cycle/simulation.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "hwparts/powercube/module_bus.h"
#include "server/collision/prepared_meshes.h"
#include "server/cycle/follow.h"
#include "server/cycle/start_overlaps.h"

namespace visum::cycle {
namespace {

hwparts::JointSample sample_of(const world::JointState& joint) {
  return {joint.position, joint.velocity, joint.effort};
}

// The four words of the world's generator from one seed (SplitMix64, Steele et al. 2014).
std::vector<std::uint64_t> seeded(std::uint64_t seed) {
  std::vector<std::uint64_t> words(4);
  for (auto& word : words) {
    seed += 0x9E3779B97F4A7C15u;
    word = (seed ^ (seed >> 30)) * 0xBF58476D1CE4E5B9u;
    word = (word ^ (word >> 27)) * 0x94D049BB133111EBu;
    word ^= word >> 31;
  }
  return words;
}

// Beside the number of pushes in a snapshot: pulls follow.
constexpr std::uint64_t kHasPulls = std::uint64_t{1} << 32;

void load_parts(std::span<BoundPart> parts, hwparts::StateReader& from) {
  for (auto& bound : parts) {
    if (bound.onlooker) continue;
    from.get(std::span<double>(bound.controller_inputs));
    from.get(std::span<double>(bound.sensor_outputs));
    bound.part->load(from);
  }
}

}  // namespace

Simulation::Simulation(scene::Scene scene, const PartMaker& make)
    : Simulation(std::move(scene), make, EnginesMade::kAll) {}

Simulation::Simulation(scene::Scene scene, const PartMaker& make, EnginesMade which)
    : make_(make),
      meshes_(std::make_shared<collision::PreparedMeshes>()),
      scene_(std::make_shared<const scene::Scene>(leave_out_overlaps(std::move(scene), *meshes_))) {
  make_parts(make_);
  make_sensors();
  make_agents();
  own_parts_ = parts_.size();
  std::vector<std::unique_ptr<dynamics::Engine>> engines;
  if (which == EnginesMade::kAll || may_make_engines(*scene_)) engines = make_engines(*scene_);
  auto machinery = make_machinery(*scene_, sensors_, *meshes_);
  meshes_->forget_unused();
  machinery.engines = std::move(engines);
  use(machinery);
  pushes_.reserve(kMaxPushes);
  pulls_.reserve(kMaxPulls);
  wrenches_.reserve(kMaxPushes + kMaxPulls);
  start_state();
}

Simulation::~Simulation() = default;

std::unique_ptr<Simulation> make_unstarted(scene::Scene scene, const PartMaker& make) {
  return std::unique_ptr<Simulation>(
      new Simulation(std::move(scene), make, Simulation::EnginesMade::kThoseOfAnyThread));
}

void Simulation::make_parts(const PartMaker& make) {
  for (const auto& plan : scene_->parts) parts_.push_back(make_bound_part(*scene_, plan, make));
}

void Simulation::make_sensors() {
  PixelBudget budget;
  for (const auto& plan : scene_->sensors) {
    parts_.push_back(make_bound_sensor(*scene_, plan));
    sensors_.push_back(sensor_of(parts_.back()));
    budget.take(*sensors_.back(), plan);
  }
}

void Simulation::make_agents() {
  first_agent_ = parts_.size();
  for (const auto& plan : scene_->agents) {
    auto agent = std::make_shared<AgentPart>(plan, scene_->world.tick_ns, parts_);
    agents_.push_back(agent.get());
    parts_.emplace_back().part = std::move(agent);
  }
}

// Swaps, so that the caller frees the old machinery where it likes. Where memory runs out, the old one stays.
void Simulation::use(Machinery& machinery) {
  try {
    machinery.senses->attach();
  } catch (...) {
    if (senses_) senses_->attach();
    throw;
  }
  std::swap(engines_, machinery.engines);
  std::swap(collision_, machinery.collision);
  std::swap(world_step_, machinery.world_step);
  std::swap(senses_, machinery.senses);
  std::swap(ring_, machinery.ring);
  std::swap(work_texts_, machinery.work_texts);
  std::swap(drives_, machinery.drives);
  std::swap(following_errors_, machinery.following_errors);
  std::swap(contact_forces_, machinery.contact_forces);
  contacts_.clear();
}

void Simulation::start_state() {
  state_ = world::initial_state(scene_->world);
  state_.random = seeded(scene_->seed);
  state_.engines.resize(scene_->world.engines.size());
  before_ = state_;
  contacts_.clear();
  pushes_.clear();
  pulls_.clear();
  fault_.clear();
  std::ranges::fill(following_errors_, 0.0);
  ring_->begin(state_.tick);
  for (auto& bound : parts_) start_ports(bound);
}

void Simulation::tick() {
  if (frozen()) return;
  if (profile_) profile_->tick_begins();
  const config::ProfileScope measured(profile_, config::Profile::kParts);
  working_.begin(state_.tick);
  end_faults();  // a restored state may hold faults whose time is over
  for (auto& bound : parts_) bound.deliver(state_.tick);
  phases_.begin();
  enter(Stage::kSense);
  sense();
  phases_.end(Phase::kSense);
  if (!agents_.empty()) {
    enter(Stage::kThink);
    think();
    phases_.end(Phase::kThink);
  }
  enter(Stage::kAct);
  act();
  phases_.end(Phase::kAct);
  enter(Stage::kCollide);
  collide();
  phases_.end(Phase::kCollide);
  enter(Stage::kStep);
  step();
  phases_.end(Phase::kStep);
  enter(Stage::kPublish);
  publish();
  end_faults();  // now, so that a write before the first tick without a fault is not lost to it
  phases_.end(Phase::kPublish);
  phases_.tick_done();
  working_.end();
  if (observer_ || second_observer_) {
    const config::ProfileScope recorded(profile_, config::Profile::kRecording);
    for (auto* observer : {observer_, second_observer_})
      if (observer) observer->ticked();
  }
  if (profile_) profile_->tick_ended();
}

void Simulation::sense() {
  for (auto& bound : parts_)
    for (std::size_t i = 0; i < bound.joints.size(); ++i)
      bound.samples[i] = sample_of(state_.joints[bound.joints[i].index()]);
}

void Simulation::think() {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    working_.enter(Stage::kThink, static_cast<std::uint32_t>(first_agent_ + i));
    agents_[i]->think(sim_time_ns());
  }
  for (auto& bound : parts_) bound.deliver(state_.tick);  // agents' writes over networks without a delay
}

void Simulation::act() {
  for (std::uint32_t part = 0; part < parts_.size(); ++part) {
    auto& bound = parts_[part];
    working_.enter(Stage::kAct, part);
    bound.part->act(bound.controller_inputs, bound.samples, bound.drives);
    for (std::size_t i = 0; i < bound.joints.size(); ++i) drives_[bound.joints[i].index()] = bound.drives[i];
  }
  const double tick_s = static_cast<double>(scene_->world.tick_ns) * 1e-9;
  for (const auto& follower : scene_->followers)
    drives_[follower.joint.index()] = follow(follower, state_, tick_s);
}

void Simulation::collide() {
  if (collision_->find(state_, contacts_)) return;
  const auto& last = contacts_.back();
  before_ = state_;
  freeze("more than " + std::to_string(contacts_.size()) + " contacts in one tick: the last is between '" +
         model().bodies[last.body_a.index()].name + "' and '" + model().bodies[last.body_b.index()].name +
         "'");
  contacts_.clear();
}

void Simulation::step() {
  if (frozen()) return;
  std::erase_if(pushes_, [this](const Push& push) { return push.until_tick <= state_.tick; });
  std::erase_if(pulls_,
                [this](const Pull& pull) { return pull.until_tick != 0 && pull.until_tick <= state_.tick; });
  const double tick_s = static_cast<double>(scene_->world.tick_ns) * 1e-9;
  wrenches_.clear();
  for (const auto& push : pushes_) wrenches_.push_back(push.wrench);
  for (const auto& pull : pulls_) wrenches_.push_back(wrench_of(pull, model(), state_, tick_s));
  before_ = state_;
  const auto entering = [this](std::uint32_t engine) { working_.enter(Stage::kStep, engine); };
  auto result = world_step_->make({engines_, tick_s, drives_, wrenches_, entering, profile_}, before_,
                                  contacts_, state_);
  if (!result.ok) return freeze(std::move(result.fault));
  std::vector<world::BodyId> limited = collision_->limited();
  const bool is_limited = result.limited || !limited.empty();
  limited.insert(limited.end(), result.fell_short.begin(), result.fell_short.end());
  if (is_limited) note_limited(limited);
  if (result.warned) ++solver_warnings_;
  if (std::string offender; !world::is_sane(scene_->world, state_, &offender))
    return freeze(std::move(offender));
  ++state_.tick;
}

void Simulation::note_limited(std::vector<world::BodyId>& bodies) {
  ++limited_ticks_;
  std::ranges::sort(bodies);
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
  bodies.resize(std::min(bodies.size(), dynamics::StepResult::kMostNamed));
  limited_bodies_.clear();
  for (const world::BodyId body : bodies) limited_bodies_.push_back(model().bodies[body.index()].name);
}

void Simulation::publish() {
  if (frozen()) return;
  sense();
  senses_->feel(before_, state_, contacts_, wrenches_);
  for (auto& bound : parts_) {
    bound.part->publish(bound.samples, bound.readings(unheard_));
    if (!bound.network.ideal()) bound.network.show(state_.tick, bound.sensor_outputs);
  }
  follow_parts();
  std::ranges::fill(contact_forces_, 0.0);
  for (const auto& contact : contacts_) {
    contact_forces_[contact.body_a.index()] += contact.normal_force_n;
    contact_forces_[contact.body_b.index()] += contact.normal_force_n;
  }
  ring_->record(state_.tick, following_errors_, contact_forces_);
}

void Simulation::freeze(std::string fault) {
  fault_ = fault.empty() ? "the engine failed without a word" : std::move(fault);
  state_ = before_;
}

std::uint64_t Simulation::state_hash() const {
  const config::ProfileScope hashed(profile_, config::Profile::kHash);
  save_all(state_, scratch_);
  return world::hash_bytes(scratch_);
}

void Simulation::save_all(const world::WorldState& state, std::vector<std::byte>& bytes) const {
  bytes.clear();
  world::save(state, bytes);
  save_rest(bytes);
}

void Simulation::save_rest(std::vector<std::byte>& bytes) const {
  hwparts::StateWriter to(bytes);
  for (const auto& bound : parts_) {
    if (bound.onlooker) continue;
    to.put(std::span<const double>(bound.controller_inputs));
    to.put(std::span<const double>(bound.sensor_outputs));
    bound.part->save(to);
  }
  // A world without pulls has the hash that it always had.
  to.put(static_cast<std::uint64_t>(pushes_.size()) | (pulls_.empty() ? 0 : kHasPulls));
  for (const auto& push : pushes_) {
    to.put(push.wrench.body.value);
    to.put(std::span<const double>(push.wrench.force_n.data(), 3));
    to.put(std::span<const double>(push.wrench.torque_nm.data(), 3));
    to.put(push.until_tick);
  }
  if (!pulls_.empty()) save_pulls(to);
  if (faults_.all().empty()) return;  // a world without faults has the hash that it always had
  faults_.save(to);
  for (const auto& bound : parts_) {
    if (!bound.network.ideal()) bound.network.save(to);
    if (const auto* modules = bound.part->modules()) modules->save_chance(to);
  }
}

void Simulation::load_rest(std::span<const std::byte> bytes) {
  hwparts::StateReader from(bytes);
  load_parts(parts_, from);
  std::uint64_t count = 0;
  from.get(count);
  const bool has_pulls = (count & kHasPulls) != 0;
  count &= ~kHasPulls;
  if (count > kMaxPushes) throw std::out_of_range("more pushes than can act at once");
  pushes_.resize(count);
  for (auto& push : pushes_) {
    from.get(push.wrench.body.value);
    if (push.wrench.body.index() >= state_.bodies.size()) throw std::out_of_range("a push of no body");
    from.get(std::span<double>(push.wrench.force_n.data(), 3));
    from.get(std::span<double>(push.wrench.torque_nm.data(), 3));
    from.get(push.until_tick);
  }
  pulls_.clear();
  if (has_pulls) load_pulls(from);
  for (auto& bound : parts_) bound.network = {};
  faults_.clear_all();
  if (!from.at_end()) load_faults(from);
  hand_out_faults();
  for (auto& bound : parts_) {
    if (!bound.network.ideal()) bound.network.load(from);
    if (auto* modules = bound.part->modules()) modules->load_chance(from);
  }
  hwparts::StateReader again(bytes);
  load_parts(parts_, again);  // handing out faults may have changed a part's supply: the saved one counts
}

Outcome Simulation::load_all(const world::WorldState& state, std::span<const std::byte> rest) {
  const world::WorldState kept = state_;
  scratch_.clear();
  save_rest(scratch_);
  Outcome outcome;
  try {
    state_ = state;
    load_rest(rest);
    return outcome;
  } catch (const std::exception& error) {
    outcome = {Refusal::kDamaged, error.what()};
  }
  state_ = kept;
  try {
    load_rest(scratch_);
  } catch (const std::exception& error) {
    before_ = state_;
    freeze(std::string("a snapshot was restored in part: ") + error.what());
  }
  return outcome;
}

}  // namespace visum::cycle
