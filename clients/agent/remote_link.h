// The view that an agent has of a part behind a connection. Inputs that the agent sets are sent together at
// the end of its turn. Lives on the agent's thread; RemoteAgent owns it. Calls throw plugin::Error for an
// index or a value that the part does not have, and visum::Error if the connection is lost.
#pragma once

#include <string>
#include <vector>

#include "clients/cpp/visum.h"
#include "protocol/plugin/plugin.h"

namespace visum::agent {

class RemoteLink final : public plugin::PartLink {
 public:
  // Takes the part's lease if `commanded`.
  RemoteLink(Client& client, const std::string& part, bool commanded);

  void end_turn();  // sends what was set
  void release();   // gives the lease back

  std::size_t input(std::string_view name) const override;
  std::size_t output(std::string_view name) const override;
  plugin::Port input_port(std::size_t input) const override;
  plugin::Port output_port(std::size_t output) const override;
  double value(std::size_t output) const override;
  double command(std::size_t input) const override;
  void set(std::size_t input, double value) override;
  std::span<const std::byte> blackboard(std::string_view name) override;

 private:
  Part part_;
  Inputs inputs_;
  Outputs outputs_;
  const bool commanded_;
  bool changed_ = false;
  std::vector<std::byte> blackboard_;
};

}  // namespace visum::agent
