#include "tests/bench/our_stepper.h"

#include <stdexcept>

#include "server/collision/collision.h"
#include "server/dynamics/kinds/engine_kinds.h"
#include "tests/dynamics/physics/engine_rows.h"

namespace visum::bench {
namespace {

world::WorldModel with_engine(world::WorldModel model, const std::string& row) {
  model.engines = {physics::engine_row(row).setting};
  return model;
}

// A tick as the cycle does it: contacts (if anything can touch), the engine, the measures of the joints.
class OurStepper : public Stepper {
 public:
  OurStepper(const world::WorldModel& model, const std::string& row)
      : model_(with_engine(model, row)),
        start_(initial_state(model_)),
        state_(start_),
        drives_(model_.joints.size()),
        engine_(dynamics::make_engine(model_, 0)),
        collision_(model_) {}

  void reset() override { state_ = start_; }
  void step() override {
    if (!model_.shapes.empty() && !collision_.find(state_, contacts_))
      throw std::runtime_error("there are more contacts than a world may have");
    const auto result =
        engine_->step({1e-9 * static_cast<double>(model_.tick_ns), contacts_, drives_, {}}, state_);
    if (!result.ok) throw std::runtime_error(result.fault);
    warned_ += result.warned;
    measure_joints(model_, state_);
  }
  void store(world::WorldState& state) const override { state = state_; }
  int warned_ticks() const override { return warned_; }

 private:
  const world::WorldModel model_;
  const world::WorldState start_;
  world::WorldState state_;
  std::vector<hwparts::JointDrive> drives_;
  std::vector<collision::Contact> contacts_;
  std::unique_ptr<dynamics::Engine> engine_;
  collision::CollisionStage collision_;
  int warned_ = 0;
};

}  // namespace

bool can_be_made(const world::WorldModel&) {
  return true;
}

std::unique_ptr<Stepper> make_our_stepper(const world::WorldModel& model, const std::string& row) {
  return std::make_unique<OurStepper>(model, row);
}

}  // namespace visum::bench
