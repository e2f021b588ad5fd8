// A part of the simulation, as an agent of the scene meets it. What is set is kept until the turn is over.
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

  void begin_turn();
  // The part takes what was set; throws plugin::Error where it refuses that.
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
  std::vector<double> inputs_;  // in this turn
  bool changed_ = false;
};

}  // namespace visum::cycle
