// The engine `ode`: Open Dynamics Engine behind the Engine seam.
#include <cstring>

#include "protocol/config/unknown_name.h"
#include "server/dynamics/engine_factories.h"
#include "server/dynamics/ode/ode_contacts.h"
#include "server/dynamics/ode/ode_guard.h"
#include "server/dynamics/ode/ode_joint.h"
#include "server/dynamics/ode/ode_world.h"
#include "server/dynamics/step_input.h"
#include "server/world/disjoint_sets.h"

namespace visum::dynamics {
namespace ode {
namespace {

// Rows that the direct solver takes at once, unless the scene sets another number; and rows of a joint (with
// its motor) and of a contact (with friction), at most.
constexpr std::uint64_t kMostRows = 3000, kRowsOfJoint = 6, kRowsOfContact = 3;

// Everything that ODE holds for one engine. It is made anew where ODE has given up.
struct Mechanism {
  Mechanism(const world::WorldModel& model, std::int32_t engine_index) : world(model, engine_index) {
    for (std::size_t i = 0; i < model.joints.size(); ++i) {
      const world::JointId id{static_cast<std::int32_t>(i)};
      if (!world.owns(model.joints[i].child)) continue;
      joint_ids.push_back(id);
      joints.emplace_back(world, model, id);
    }
  }

  OdeWorld world;  // must outlive the contacts' group, which is part of it
  std::vector<world::JointId> joint_ids;
  std::vector<OdeJoint> joints;
  OdeContacts contacts;
};

// QuickStep shuffles its rows with one random generator for the whole process. The seed is part of this
// world's state: it is set before a step and read back after it, so that worlds do not disturb each other.
class Seed {
 public:
  explicit Seed(std::vector<std::byte>& bytes) : bytes_(bytes) {
    std::uint64_t seed = 0;
    if (bytes_.size() == sizeof seed) std::memcpy(&seed, bytes_.data(), sizeof seed);
    dRandSetSeed(seed);
  }
  ~Seed() {
    const std::uint64_t seed = dRandGetSeed();
    bytes_.resize(sizeof seed);
    std::memcpy(bytes_.data(), &seed, sizeof seed);
  }
  Seed(const Seed&) = delete;
  Seed& operator=(const Seed&) = delete;

 private:
  std::vector<std::byte>& bytes_;
};

// One instance for each engine entry of the scene, on the tick's thread. Where ODE gives up, the step fails
// with ODE's message, and the ODE world is built anew.
class OdeEngine : public Engine {
 public:
  OdeEngine(const world::WorldModel& model, std::int32_t engine_index)
      : model_(model), engine_index_(engine_index), quick_(setting().step == "quick") {
    if (!quick_ && setting().step != "world")
      throw std::runtime_error("engine 'ode': " +
                               config::unknown_name("step", setting().step, {"world", "quick"}));
    ensure_ode();
    mechanism_ = std::make_unique<Mechanism>(model_, engine_index_);
  }

  bool may_repeat() const override { return true; }

  StepResult step(const StepInput& input, world::WorldState& state) override {
    if (std::string fault = find_input_fault(model_, input, state); !fault.empty()) return {false, fault};
    const std::uint64_t messages_before = ode_messages();
    too_many_.clear();
    std::string failure;
    try {
      ensure_ode();
      advance(input, state);
    } catch (const OdeError& error) {
      failure = error.what();
    }
    // ODE's messages count as warnings of the solver.
    if (failure.empty()) return check(state, ode_messages() != messages_before || !too_many_.empty());
    failure += first_broken_body();
    rebuild();
    return {false, failure};
  }

 private:
  const world::EngineSetting& setting() const {
    return model_.engines[static_cast<std::size_t>(engine_index_)];
  }

  void advance(const StepInput& input, world::WorldState& state) {
    std::vector<std::byte>& bytes = state.engines[static_cast<std::size_t>(engine_index_)];
    prepare(input, state);
    if (quick_) {
      step_quickly(input.tick_s, bytes);
    } else if (find_too_many(input.contacts) || !step_directly(input.tick_s)) {
      // The direct solver would take too long, or has left forces out: the iterative one makes the tick.
      prepare(input, state);
      dRandSetSeed(0);  // the seed of this tick alone
      dWorldQuickStep(mechanism_->world.id(), input.tick_s);
    }
    mechanism_->world.store(state);
    for (std::size_t i = 0; i < mechanism_->joints.size(); ++i)
      state.joints[mechanism_->joint_ids[i].index()].effort = mechanism_->joints[i].effort();
    mechanism_->contacts.report(input.contacts);
  }

  // ODE's direct solver takes bodies that are joined together at once, and its work grows with the third
  // power of their rows. Returns true if there are more rows anywhere than the limit allows, and notes some
  // of the bodies there.
  bool find_too_many(std::span<const collision::Contact> contacts) {
    const auto moves = [&](world::BodyId id) { return id.valid() && !model_.bodies[id.index()].fixed; };
    // Calls act(a, b, rows) for all that joins; a body that does not move is left out.
    const auto each = [&](auto act) {
      const auto join = [&](world::BodyId a, world::BodyId b, std::uint64_t rows) {
        if (mechanism_->world.owns(a) || mechanism_->world.owns(b))
          act((moves(a) ? a : b).index(), (moves(b) ? b : a).index(), rows);
      };
      for (const world::JointId id : mechanism_->joint_ids)
        join(model_.joints[id.index()].child, model_.joints[id.index()].parent, kRowsOfJoint);
      for (const collision::Contact& contact : contacts) join(contact.body_a, contact.body_b, kRowsOfContact);
    };
    joined_.separate(model_.bodies.size());
    rows_.assign(model_.bodies.size(), 0);
    each([&](std::size_t a, std::size_t b, std::uint64_t) { joined_.join(a, b); });
    each([&](std::size_t a, std::size_t, std::uint64_t rows) { rows_[joined_.leader(a)] += rows; });
    const std::uint64_t most = setting().work_limit != 0 ? setting().work_limit : kMostRows;
    for (std::size_t i = 0; i < model_.bodies.size() && too_many_.size() < StepResult::kMostNamed; ++i)
      if (const world::BodyId id{static_cast<std::int32_t>(i)};
          mechanism_->world.owns(id) && rows_[joined_.leader(i)] > most)
        too_many_.push_back(id);
    return !too_many_.empty();
  }

  // Loads everything that a step acts on, from the state and the input alone.
  void prepare(const StepInput& input, const world::WorldState& state) {
    mechanism_->world.load(state);
    mechanism_->contacts.make(mechanism_->world, setting(), input.tick_s, input.contacts, state);
    for (std::size_t i = 0; i < mechanism_->joints.size(); ++i)
      mechanism_->joints[i].apply(input.drives[mechanism_->joint_ids[i].index()], state);
    push(input.wrenches);
  }

  // Returns false where ODE's direct solver has given up on some contacts, which may happen where many share
  // a load. ODE then prints a message and leaves their forces at zero, so that a stack falls. The iterative
  // solver does this tick instead.
  bool step_directly(double tick_s) {
    const std::uint64_t before = ode_messages();
    dWorldStep(mechanism_->world.id(), tick_s);
    return ode_messages() == before;
  }

  void step_quickly(double tick_s, std::vector<std::byte>& bytes) {
    const Seed seed(bytes);
    dWorldQuickStep(mechanism_->world.id(), tick_s);
  }

  void push(std::span<const Wrench> wrenches) {
    for (const Wrench& wrench : wrenches) {
      if (!mechanism_->world.owns(wrench.body)) continue;
      const dBodyID body = mechanism_->world.body(wrench.body);
      dBodyAddForce(body, wrench.force_n.x(), wrench.force_n.y(), wrench.force_n.z());
      dBodyAddTorque(body, wrench.torque_nm.x(), wrench.torque_nm.y(), wrench.torque_nm.z());
    }
  }

  StepResult check(const world::WorldState& state, bool warned) const {
    std::string offender;
    const bool sane = is_sane(model_, state, &offender);
    return {sane, offender, warned, !too_many_.empty(), too_many_};
  }

  // Text for the fault: the body at which ODE gave up.
  std::string first_broken_body() const {
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      const world::BodyId id{static_cast<std::int32_t>(i)};
      if (!mechanism_->world.owns(id)) continue;
      const dBodyID body = mechanism_->world.body(id);
      const auto vector = [](const dReal* from) { return Eigen::Map<const Eigen::Vector3d>(from); };
      if (!vector(dBodyGetPosition(body)).allFinite() || !vector(dBodyGetLinearVel(body)).allFinite() ||
          !vector(dBodyGetAngularVel(body)).allFinite() || !vector(dBodyGetForce(body)).allFinite())
        return ", at body '" + model_.bodies[i].name + "'";
    }
    return "";
  }

  void rebuild() {
    mechanism_.reset();
    mechanism_ = std::make_unique<Mechanism>(model_, engine_index_);
  }

  const world::WorldModel& model_;
  std::int32_t engine_index_;
  bool quick_;
  world::DisjointSets joined_;
  std::vector<std::uint64_t> rows_;      // by leader: of all that is joined to it
  std::vector<world::BodyId> too_many_;  // in this tick: bodies whose rows are beyond the limit
  std::unique_ptr<Mechanism> mechanism_;
};

}  // namespace
}  // namespace ode

std::unique_ptr<Engine> make_ode_engine(const world::WorldModel& model, std::int32_t engine_index) {
  return std::make_unique<ode::OdeEngine>(model, engine_index);
}

}  // namespace visum::dynamics
