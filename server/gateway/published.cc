#include "server/gateway/published.h"

namespace visum::gateway {
namespace {

void fill_bodies(Published& published, const cycle::Simulation& simulation) {
  const auto& bodies = simulation.model().bodies;
  published.poses.clear();
  published.velocities.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto& state = simulation.state().bodies[i];
    const auto X_WB = world::link_pose(bodies[i], state);
    const auto v_WB = world::link_velocity(bodies[i], state);
    for (double number : {X_WB.p.x(), X_WB.p.y(), X_WB.p.z(), X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()})
      published.poses.push_back(number);
    for (const auto& vector : {v_WB, state.w_WB})
      for (int axis = 0; axis < 3; ++axis) published.velocities.push_back(vector[axis]);
  }
}

void fill_parts(Published& published, const cycle::Simulation& simulation,
                const std::shared_ptr<const PartTable>& table) {
  const auto parts = simulation.parts();
  if (published.table != table) {
    published.table = table;
    published.parts.assign(table->slots.size(), {});
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    auto& part = published.parts[table->slot_of[i]];
    part.controller_inputs = parts[i].controller_inputs;
    part.sensor_outputs = parts[i].sensor_outputs;
  }
  const auto faults = simulation.faults();
  published.faults.assign(faults.begin(), faults.end());
  for (auto& active : published.faults) active.part = table->slot_of[active.part];
}

void fill_joints(Published& published, const cycle::Simulation& simulation) {
  published.joint_positions.clear();
  published.joint_velocities.clear();
  published.joint_efforts.clear();
  for (const auto& joint : simulation.state().joints) {
    published.joint_positions.push_back(joint.position);
    published.joint_velocities.push_back(joint.velocity);
    published.joint_efforts.push_back(joint.effort);
  }
  const auto errors = simulation.following_errors();
  published.following_errors.assign(errors.begin(), errors.end());
}

}  // namespace

std::string frozen_reason(const Published& published) {
  if (published.dump.empty()) return published.fault;
  return published.fault + "; the ticks before it are in " + published.dump;
}

std::uint64_t state_hash(const Published& published) {
  return published.hashed_by ? published.hashed_by->state_hash() : published.state_hash;
}

void fill(Published& published, const cycle::Simulation& simulation, const Pace& pace,
          const std::shared_ptr<const PartTable>& table) {
  fill_unhashed(published, simulation, pace, table);
  published.state_hash = simulation.state_hash();
  published.hashed_by = nullptr;
}

void fill_unhashed(Published& published, const cycle::Simulation& simulation, const Pace& pace,
                   const std::shared_ptr<const PartTable>& table) {
  published.hashed_by = &simulation;
  published.tick = simulation.tick_count();
  published.sim_time_ns = simulation.sim_time_ns();
  published.era = simulation.era();
  published.revision = simulation.revision();
  published.fault = simulation.fault();
  published.pace = pace;
  published.phases = simulation.phases().summary();
  published.solver_warnings = simulation.solver_warnings();
  published.limited_ticks = simulation.limited_ticks();
  published.limited_bodies = simulation.limited_bodies();
  published.ring = simulation.ring();
  published.work_texts = simulation.work_texts();
  fill_parts(published, simulation, table);
  fill_bodies(published, simulation);
  fill_joints(published, simulation);
  const auto contacts = simulation.contacts();
  published.contacts.assign(contacts.begin(), contacts.end());
}

}  // namespace visum::gateway
