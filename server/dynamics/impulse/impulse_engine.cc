// The engine `impulse`: it looks ahead and finds the impulses that will hold the joints (see README.md beside
// this file).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "protocol/config/unknown_name.h"
#include "server/dynamics/engine_factories.h"
#include "server/dynamics/impulse/composition.h"
#include "server/dynamics/impulse/sleep.h"
#include "server/dynamics/impulse/stepper.h"
#include "server/dynamics/impulse/warm_start.h"
#include "server/dynamics/step_input.h"

namespace visum::dynamics {
namespace impulse {
namespace {

// Units of work for a tick, and more for each contact, unless the scene sets another number; see README.md.
constexpr std::uint64_t kWorkLimit = 50'000'000, kWorkPerContact = 5'000;
constexpr int kMostHalvings = 6;  // a tick's steps may be cut down to 1/64

// True if the joint's position counts more than one turn.
bool counts_turns(const world::Joint& joint) {
  return joint.kind == world::JointKind::kScrew || joint.kind == world::JointKind::kTorsionSpring;
}

// One instance for each engine entry of the scene. Lives on the tick's thread, owned by the simulation. A
// step that fails returns its fault in words; the state must then not be used.
class ImpulseEngine : public Engine {
 public:
  ImpulseEngine(const world::WorldModel& model, std::int32_t engine_index)
      : index_(static_cast<std::size_t>(engine_index)),
        plant_(model, engine_index),
        stepper_(plant_),
        sleep_(plant_) {
    within_.joints.resize(model.joints.size());
    for (std::size_t i = 0; i < model.joints.size(); ++i)
      if (counts_turns(model.joints[i])) turning_.push_back(i);
    if (plant_.setting.solver != "direct" && plant_.setting.solver != "iterate")
      throw std::runtime_error("engine 'impulse': " +
                               config::unknown_name("solver", plant_.setting.solver, {"direct", "iterate"}));
    if (plant_.setting.solver == "iterate" && plant_.setting.order != 2)
      throw std::runtime_error(
          "engine 'impulse': solver 'iterate' has order 2 only; set order: 2, or solver: direct (orders 4 "
          "and 6 "
          "step back in time, which would gain the energy that an iteration loses)");
  }

  bool may_repeat() const override { return true; }

  StepResult step(const StepInput& input, world::WorldState& state) override {
    if (std::string fault = find_input_fault(plant_.model, input, state); !fault.empty())
      return {false, fault};
    // A limited tick starts from what was reached, and of islands that stand nothing was.
    std::optional<bool> made = make_within_limit(true, input, state);
    if (!made && stepper_.standing().any()) made = make_within_limit(false, input, state);
    const bool limited = !made;
    bool ok = made.value_or(true);
    const std::uint64_t work = plant_.work.taken();
    // With `solver: iterate` the bodies stay together at any price: those that cannot move stay where they
    // are.
    const bool stuck = !ok && plant_.setting.solver == "iterate";
    if (limited || stuck) make_limited(input, state);
    ok = ok || stuck;
    if (!ok) return {false, broken_text()};
    StepResult result = store(input, state);
    result.limited = limited;
    result.work = work;
    result.standing = std::ranges::count_if(plant_.touches, &Touch::stands);
    if (limited) name_short(result.fell_short);
    return result;
  }

 private:
  // Makes the tick. Returns false where a step cannot be made, and nothing where the limit of work is met.
  std::optional<bool> make_within_limit(bool may_stand, const StepInput& input,
                                        const world::WorldState& state) {
    try {
      try {
        return make(false, may_stand, input, state);
      } catch (const NeedsOneThread&) {
        return make(true, may_stand, input, state);
      }
    } catch (const WorkSpent&) {
      return {};
    }
  }

  bool make(bool one_thread, bool may_stand, const StepInput& input, const world::WorldState& state) {
    stepper_.begin_tick(one_thread);
    prepare(input, state, may_stand);
    warned_ = false;
    plant_.work.start(work_limit());
    // Orders above 2 need the factors to decide on the stages.
    if (plant_.setting.order > 2) stepper_.factor(input.tick_s, state);
    bool ok = true;
    for (const double share : stages(plant_, input.tick_s))
      ok = ok && advance(share * input.tick_s, 0, input, state);
    return ok;
  }

  // Units that this tick may take.
  std::uint64_t work_limit() const {
    const std::uint64_t set = plant_.setting.work_limit;
    return set != 0 ? set : kWorkLimit + kWorkPerContact * plant_.touches.size();
  }

  // Loads everything that a tick starts from: bodies, sleep, drives, contacts, warm start. `may_stand`: if
  // the tick is not made anew in another way.
  void prepare(const StepInput& input, const world::WorldState& state, bool may_stand = false) {
    has_moved_ = false;
    moved_s_ = 0.0;
    plant_.bodies.load(state);
    const std::vector<std::byte>& kept = state.engines[index_];
    sleep_.begin(input, state, kept, plant_);
    prepare_axes(plant_, input.drives, state);
    for (Spring& spring : plant_.springs) spring.total = 0.0;
    list_touches(plant_, input.contacts);
    plant_.islands.find(plant_, input.wrenches);
    // The memory ends with the guard's part, then that of sleep.
    const std::size_t guard = stepper_.guard().bytes(), rest = std::min(kept.size(), guard + sleep_.bytes());
    const auto first = std::span(kept).first(kept.size() - rest);
    warm_start_ = read_warm_start(first, input.contacts, plant_);
    stepper_.load_touches(input, state, warm_start_, may_stand);
    stepper_.guard().read(std::span(kept).subspan(first.size(), std::min(guard, rest)));
  }

  // Makes the tick anew as one limited step, whose work is bounded by itself. It starts from the contacts'
  // impulses that were reached, unless the tick had been cut already. Where that gains so much energy that
  // bodies have to stay where they were, it starts from none.
  void make_limited(const StepInput& input, const world::WorldState& state) {
    const bool whole = !has_moved_ && !warned_;
    reached_.clear();
    for (const Touch& touch : plant_.touches) reached_.push_back(touch.impulse[kAhead]);
    plant_.work.start(UINT64_MAX);
    prepare(input, state);
    for (std::size_t i = 0; whole && i < reached_.size(); ++i)
      if (reached_[i].allFinite()) plant_.touches[i].impulse[kAhead] = reached_[i];
    if (!stepper_.step_limited(input.tick_s, input.wrenches, state)) {
      prepare(input, state);
      for (Touch& touch : plant_.touches) touch.impulse[kAhead] = touch.twist[kAhead] = Vector3d::Zero();
      for (Axis& axis : plant_.axes) axis.kept_stops = {};
      stepper_.step_limited(input.tick_s, input.wrenches, state);
    }
    warned_ = true;
  }

  // The bodies that fell short, each once, in the order of their numbers.
  void name_short(std::vector<world::BodyId>& names) const {
    std::vector<std::size_t> numbers(stepper_.short_bodies().begin(), stepper_.short_bodies().end());
    std::ranges::sort(numbers);
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    numbers.resize(std::min(numbers.size(), StepResult::kMostNamed));
    for (const std::size_t i : numbers) names.push_back(plant_.bodies.constants[i].id);
  }

  // Moves all by h. If the joints do not close, the step is made of two steps of half the length, down to
  // kMostHalvings.
  bool advance(double h, int halvings, const StepInput& input, const world::WorldState& state) {
    if (moved_s_ != 0.0) measure_axes(plant_, moved_s_);
    moved_s_ = 0.0;
    Moving& before = before_[static_cast<std::size_t>(halvings)];
    if (has_moved_) before.keep(plant_);
    const world::WorldState& joints = has_moved_ && !turning_.empty() ? within_ : state;
    // Joint states at the start of this step: those of the tick, or as far as the tick has turned them.
    if (stepper_.step(h, input.wrenches, joints, kMostHalvings - halvings)) {
      warned_ = warned_ || stepper_.fell_short();
      turn_on(h, state);
      has_moved_ = true;
      moved_s_ = h;
      return true;
    }
    // Back to the start of the step; at the start of the tick everything is loaded anew.
    if (has_moved_)
      before.put_back(plant_);
    else
      prepare(input, state);
    warned_ = true;
    if (stepper_.take_firmly()) return advance(h, halvings, input, state);
    if (halvings == kMostHalvings) return false;
    return advance(0.5 * h, halvings + 1, input, state) && advance(0.5 * h, halvings + 1, input, state);
  }

  // Steps of one tick may together turn a joint by more than half a turn, so its position is carried on.
  void turn_on(double h, const world::WorldState& state) {
    if (turning_.empty()) return;
    if (!has_moved_) within_.joints = state.joints;
    for (const std::size_t i : turning_) within_.joints[i].position += h * state.joints[i].velocity;
  }

  // Fault text of a step that cannot be made: names the joint, or a body with contacts.
  std::string broken_text() const {
    const JointSpec* joint = stepper_.broken();
    if (joint == nullptr) return "the contacts of body '" + first_body() + "' have no solution";
    return "joint '" + joint->model->name + "' on body '" +
           plant_.model.bodies[joint->model->child.index()].name + "' cannot be held together";
  }

  std::string first_body() const {
    return plant_.touches.empty() ? ""
                                  : plant_.model
                                        .bodies[plant_.bodies
                                                    .constants[static_cast<std::size_t>(
                                                        std::max(plant_.touches[0].a, plant_.touches[0].b))]
                                                    .id.index()]
                                        .name;
  }

  // Writes bodies, efforts, contact forces and the engine's memory to the state. Impulses over the tick are
  // forces.
  StepResult store(const StepInput& input, world::WorldState& state) {
    plant_.bodies.store(state);
    for (const Axis& axis : plant_.axes)
      if (!plant_.mechanism_asleep[axis.mechanism])
        state.joints[axis.joint.index()].effort =
            axis.idle ? 0.0 : axis.total / input.tick_s + axis.feedforward;
    for (const Spring& spring : plant_.springs)
      if (!is_asleep(plant_, spring))
        state.joints[spring.spec.id.index()].effort = spring.total / input.tick_s;
    for (const Touch& touch : plant_.touches) {
      if (touch.stands) continue;
      collision::Contact& contact = input.contacts[touch.contact];
      contact.normal_force_n = touch.total_normal / input.tick_s;
      contact.force_on_a_W = touch.total / input.tick_s;
      contact.torque_on_a_W = touch.total_twist / input.tick_s;
    }
    stepper_.note_standing(input, warm_start_);
    const std::size_t warm = warm_start_bytes(plant_), guard = stepper_.guard().bytes();
    memory_.resize(warm + guard + sleep_.bytes());
    write_warm_start(plant_, input.contacts, warm_start_, memory_);
    stepper_.guard().write(std::span(memory_).subspan(warm, guard));
    sleep_.write(memory_);
    std::swap(state.engines[index_], memory_);
    memory_.reserve(state.engines[index_].capacity());
    std::string offender;
    if (!is_sane(plant_.model, state, &offender)) return {false, offender};
    return {.warned = warned_};
  }

  // Everything that a step changes, kept to be restored when an earlier step of the same tick has moved it
  // already.
  struct Moving {
    void keep(Plant& plant) {
      plant.bodies.keep(bodies);
      axes.clear();
      for (const Axis& axis : plant.acting_axes()) axes.push_back(axis);
      touches = plant.touches;
    }
    void put_back(Plant& plant) const {
      plant.bodies.put_back(bodies);
      std::size_t i = 0;
      for (Axis& axis : plant.acting_axes()) axis = axes[i++];
      plant.touches = touches;
    }
    BodiesMotion bodies;
    std::vector<Axis> axes;  // those that are not idle
    std::vector<Touch> touches;
  };

  std::size_t index_;
  Plant plant_;
  Stepper stepper_;
  Sleep sleep_;
  WarmStart warm_start_;              // of this tick, while it is made
  std::vector<std::byte> memory_;     // its part of the state, as the tick leaves it
  world::WorldState within_;          // joints only: where the steps of this tick have led them so far
  std::vector<std::size_t> turning_;  // the joints in it that matter
  bool has_moved_ = false;            // in this tick
  double moved_s_ = 0.0;              // length of the last step of this tick: the axes must still be measured
  std::array<Moving, kMostHalvings + 1> before_;  // by number of halvings
  bool warned_ = false;                           // in this tick
  std::vector<Vector3d> reached_;  // by touch: impulses of the look-ahead when the work was spent
};

}  // namespace
}  // namespace impulse

std::unique_ptr<Engine> make_impulse_engine(const world::WorldModel& model, std::int32_t engine_index) {
  return std::make_unique<impulse::ImpulseEngine>(model, engine_index);
}

}  // namespace visum::dynamics
