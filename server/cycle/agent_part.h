// An agent of the scene, as a part of the world. Once per period, in the phase "think", the agent reads the
// outputs of parts and writes the inputs of the parts that it commands. Clients see it as a part with outputs
// only: the agent's own, then `Turns` and `Node State` (0: it works; 1: it is in fault, and the blackboard
// `fault` says why).
//
// Lives on the tick's thread, among Simulation::parts(). The agent's code comes from a plug-in. An exception
// or nonsense from it puts the agent in fault: it thinks no more, and the parts that it commanded lose their
// controller.
#pragma once

#include <memory>
#include <vector>

#include "hwparts/part.h"
#include "hwparts/plugged/node_guard.h"
#include "server/scene/scene.h"

namespace visum::cycle {

struct BoundPart;
class BoundLink;

class AgentPart final : public hwparts::Part {
 public:
  // `parts` holds the scene's parts, then its sensors; this agent and those after it will be appended. Keeps
  // references to `plan` and `parts`. Throws ConfigError.
  AgentPart(const scene::AgentPlan& plan, std::int64_t tick_ns, std::vector<BoundPart>& parts);
  ~AgentPart() override;

  // Once per tick, at its beginning. Does nothing until the agent's next turn.
  void think(std::int64_t now_ns);

  const protocol::PartDescription& description() const override { return description_; }
  std::span<const std::size_t> joints() const override { return {}; }
  std::optional<std::string> refuse(std::span<const double>) const override { return {}; }
  void act(std::span<const double>, std::span<const hwparts::JointSample>,
           std::span<hwparts::JointDrive>) override {}
  void publish(std::span<const hwparts::JointSample>, std::span<double> sensor_outputs) override;
  void following_errors(std::span<double>) const override {}
  void controller_lost() override {}
  void reset() override;
  std::span<const std::byte> read_blackboard(std::size_t) const override { return guard_.blackboard(); }
  const std::string* node_fault() const override { return &guard_.fault(); }
  void save(hwparts::StateWriter& to) const override;
  void load(hwparts::StateReader& from) override;

 private:
  class Context;

  // True where a period begins in the tick that begins now.
  bool due(std::int64_t now_ns) const;
  void start_outputs();
  // Takes the agent's parts from it, once it is in fault.
  void let_go();

  const std::int64_t tick_ns_, period_ns_;
  std::vector<std::unique_ptr<BoundLink>> links_;  // to the parts that it uses
  std::unique_ptr<plugin::Agent> agent_;
  plugged::NodeGuard guard_;
  std::vector<double> outputs_;  // the agent's own
  std::uint64_t turns_ = 0;
  protocol::PartDescription description_;
};

}  // namespace visum::cycle
