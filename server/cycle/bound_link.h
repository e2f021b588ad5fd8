// A part of the simulation as an agent of the scene sees it. What the agent sets is kept until its turn is
// over, and then reaches the part as one write. Lives on the tick's thread; the AgentPart owns it. Wrong use
// by the plug-in throws plugin::Error.
#pragma once

#include <string>
#include <vector>

#include "protocol/plugin/plugin.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {

class BoundLink final : public plugin::PartLink {
 public:
  BoundLink(std::vector<BoundPart>& parts, std::size_t number, bool commanded)
      : parts_(parts), number_(number), commanded_(commanded) {}

  bool commanded() const { return commanded_; }

  // Copies the part's inputs, as the agent last wrote them.
  void begin_turn();
  // Sends the inputs to the part if any was set. Throws plugin::Error where the part refuses them.
  void end_turn(std::int64_t tick);
  void lose_controller();

  std::size_t input(std::string_view name) const override;
  std::size_t output(std::string_view name) const override;
  plugin::Port input_port(std::size_t input) const override;
  plugin::Port output_port(std::size_t output) const override;
  double value(std::size_t output) const override;
  double command(std::size_t input) const override;
  void set(std::size_t input, double value) override;
  std::span<const std::byte> blackboard(std::string_view name) override;

 private:
  const protocol::PartDescription& description() const;
  BoundPart& part() const { return parts_[number_]; }

  std::vector<BoundPart>& parts_;
  const std::size_t number_;
  const bool commanded_;
  std::vector<double> inputs_;  // of this turn; empty before the first
  bool changed_ = false;
};

}  // namespace visum::cycle
