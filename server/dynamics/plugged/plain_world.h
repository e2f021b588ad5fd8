// The world as plug-ins' engines see it: plain values, bodies by their centres of mass, and only those joints
// and contacts that belong to the engine's own bodies. Nothing here allocates once warm.
#pragma once

#include <vector>

#include "protocol/plugin/plugin.h"
#include "server/dynamics/engine.h"

namespace visum::dynamics::plugged {

// PluggedEngine owns it; tick's thread. Order of calls in a step: load(), tick(), the plug-in's step,
// store().
class PlainWorld {
 public:
  // Throws plugin::Error at a joint of a kind that plug-ins do not know.
  PlainWorld(const world::WorldModel& model, std::int32_t engine_index);

  double tick_s;
  std::vector<plugin::EngineBody> bodies;  // by BodyId
  std::vector<plugin::EngineJoint> joints;

  // Copies the state and the inputs of this engine's bodies.
  void load(const StepInput& input, const world::WorldState& state);
  // The values that the plug-in's step reads and writes.
  plugin::EngineTick tick(double tick_s);
  // Copies the plug-in's results to the state. Throws plugin::Error at an effort or a force that is not
  // finite.
  void store(const StepInput& input, world::WorldState& state) const;

 private:
  void add_joint(const world::Joint& joint, world::JointId id);
  bool owns(world::BodyId body) const { return bodies[body.index()].own; }

  const world::WorldModel& model_;
  std::vector<world::JointId> joint_ids_;  // by number in `joints`
  std::vector<std::size_t> contact_ids_;   // by number in contacts_: index in StepInput::contacts
  std::vector<plugin::EnginePush> pushes_;
  std::vector<plugin::JointDrive> drives_;
  std::vector<plugin::JointSample> samples_;
  std::vector<plugin::EngineContact> contacts_;
  std::vector<plugin::Motion> motions_;
  std::vector<double> efforts_;
};

}  // namespace visum::dynamics::plugged
