// The world as plug-ins' engines see it: plain values, bodies by their centres of mass, and of the joints and
// contacts those of the engine's own bodies. Nothing here allocates once warm.
#pragma once

#include <vector>

#include "protocol/plugin/plugin.h"
#include "server/dynamics/engine.h"

namespace visum::dynamics::plugged {

class PlainWorld {
 public:
  // Throws plugin::Error at a joint that plug-ins cannot be told of.
  PlainWorld(const world::WorldModel& model, std::int32_t engine_index);

  double tick_s;
  std::vector<plugin::EngineBody> bodies;  // by BodyId
  std::vector<plugin::EngineJoint> joints;

  void load(const StepInput& input, const world::WorldState& state);
  plugin::EngineTick tick(double tick_s);
  // Throws plugin::Error at an effort or a force that is no number.
  void store(const StepInput& input, world::WorldState& state) const;

 private:
  void add_joint(const world::Joint& joint, world::JointId id);
  bool owns(world::BodyId body) const { return bodies[body.index()].own; }

  const world::WorldModel& model_;
  std::vector<world::JointId> joint_ids_;  // of joints
  std::vector<std::size_t> contact_ids_;   // in StepInput::contacts
  std::vector<plugin::EnginePush> pushes_;
  std::vector<plugin::JointDrive> drives_;
  std::vector<plugin::JointSample> samples_;
  std::vector<plugin::EngineContact> contacts_;
  std::vector<plugin::Motion> motions_;
  std::vector<double> efforts_;
};

}  // namespace visum::dynamics::plugged
