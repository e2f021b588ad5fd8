#include "tests/bench/peers/peers.h"
#include "tests/bench/peers/simbody_chain.h"

namespace visum::bench {
namespace {

std::vector<Pin> pins_of(const world::WorldModel& model) {
  std::vector<Pin> pins;
  for (const auto& joint : model.joints) {
    const auto& body = model.bodies[joint.child.index()];
    pins.push_back({joint.parent.value, joint.X_PJ.p, joint.axis_J, body.mass_kg, body.p_BC, body.inertia_C,
                    joint.initial_position});
  }
  return pins;
}

class Simbody : public Stepper {
 public:
  explicit Simbody(const world::WorldModel& model)
      : chain_(model.gravity, 1e-9 * static_cast<double>(model.tick_ns), pins_of(model)) {}

  void reset() override { chain_.reset(); }
  void step() override { chain_.step(); }
  void store(world::WorldState& state) const override {
    const auto motions = chain_.motions();
    for (std::size_t i = 0; i < motions.size(); ++i)
      state.bodies[i] = {motions[i].p, motions[i].q, motions[i].v, motions[i].w};
  }

 private:
  SimbodyChain chain_;
};

std::unique_ptr<Stepper> make(const world::WorldModel& model, const std::string&) {
  return std::make_unique<Simbody>(model);
}

}  // namespace

void add_simbody(std::vector<StepperKind>& kinds) {
  kinds.push_back({"simbody", is_open_chain, make});
}

}  // namespace visum::bench
