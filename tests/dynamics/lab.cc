#include "tests/dynamics/lab.h"

#include <cmath>
#include <stdexcept>

#include "server/dynamics/kinds/engine_kinds.h"

namespace visum::dynamics::testing {
namespace {

world::WorldModel checked(world::WorldModel model) {
  if (const std::string fault = find_fault(model); !fault.empty()) throw std::runtime_error(fault);
  return model;
}

}  // namespace

Lab::Lab(world::WorldModel world_model)
    : model(checked(std::move(world_model))),
      state(initial_state(model)),
      drives(model.joints.size()),
      stage_(model),
      world_step_(model, stage_) {
  for (std::size_t i = 0; i < model.engines.size(); ++i)
    engines.push_back(make_engine(model, static_cast<std::int32_t>(i)));
}

StepResult Lab::step() {
  stage_.find(state, contacts);
  before_ = state;
  const StepResult all = world_step_.make({engines, tick_s(), drives, wrenches}, before_, contacts, state);
  if (!all.ok) return all;
  if (all.warned) ++warned_ticks;
  ++state.tick;
  return all;
}

void Lab::run(double seconds) {
  run_ticks(static_cast<int>(std::lround(seconds / tick_s())));
}

void Lab::run_ticks(int ticks) {
  for (int i = 0; i < ticks; ++i) {
    if (const StepResult result = step(); !result.ok) throw std::runtime_error(result.fault);
  }
}

std::vector<std::byte> Lab::bytes() const {
  std::vector<std::byte> result;
  save(state, result);
  return result;
}

std::uint64_t Lab::hash() const {
  return world::hash_bytes(bytes());
}

double Lab::normal_force_between(const std::string& a, const std::string& b) const {
  const world::BodyId first = model.find_body(a), second = model.find_body(b);
  double sum = 0.0;
  for (const collision::Contact& contact : contacts) {
    const bool same = (contact.body_a == first && contact.body_b == second) ||
                      (contact.body_a == second && contact.body_b == first);
    if (same) sum += contact.normal_force_n;
  }
  return sum;
}

double Lab::kinetic_energy() const {
  double energy = 0.0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const world::Body& body = model.bodies[i];
    if (body.fixed) continue;
    const Eigen::Vector3d w_B = state.bodies[i].q_WB.conjugate() * state.bodies[i].w_WB;
    energy += 0.5 * body.mass_kg * state.bodies[i].v_WC.squaredNorm() + 0.5 * w_B.dot(body.inertia_C * w_B);
  }
  return energy;
}

}  // namespace visum::dynamics::testing
