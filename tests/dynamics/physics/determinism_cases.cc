// D: the same bits.
#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

double differs(bool equal) {
  return equal ? 0.0 : 1.0;
}

// Twice from the start, and once from a state that was kept half-way, in another engine.
std::vector<double> replay(const world::WorldModel& model, double seconds) {
  Lab first(model), second(model), restored(model);
  first.run(0.5 * seconds);
  restored.state = first.state;
  first.run(0.5 * seconds);
  restored.run(0.5 * seconds);
  second.run(seconds);
  return {differs(first.hash() == second.hash()), differs(first.hash() == restored.hash())};
}

std::vector<double> replay_arm(const world::EngineSetting& engine) {
  return replay(arm7(engine, 1e-3), 0.5);
}

std::vector<double> replay_stack(const world::EngineSetting& engine) {
  auto model = stack(engine, 1e-3, 4);
  model.bodies[2].w_WB = {0.5, 1.0, -2.0};
  return replay(model, 0.5);
}

}  // namespace

std::vector<Case> determinism_cases() {
  const std::vector<Figure> bits{{"replay_differs", 0.0}, {"restore_differs", 0.0}};
  return {{"D1", "ArmReplaysToTheBit", "the same bits", bits, replay_arm},
          {"D2", "TumblingStackReplaysToTheBit", "the same bits", bits, replay_stack}};
}

}  // namespace visum::physics
