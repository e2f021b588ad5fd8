// The server's parts as a bridge needs them: their values, and commands that answer with a text instead of an
// exception. It belongs to the bridge's one thread. A lost server throws visum::Error (kConnection), which
// ends the bridge.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "clients/cpp/visum.h"

namespace visum::bridge {

class Plant {
 public:
  Plant(const std::string& address, const ClientOptions& options);

  Client& client() { return client_; }
  std::vector<Part>& parts() { return parts_; }
  std::vector<std::string> names() const;

  // Brings the ports of all parts up to date: one round trip for each part.
  void refresh();

  // Returns why set_input() would refuse the value for its range; it asks nobody.
  std::string check_input(std::size_t part, std::size_t port, double value) const;

  // Commands. Each returns the reason of the refusal, or an empty text once the server has accepted it.
  //
  // The lease is taken for the one command and released in good order, so that the value holds and the part
  // is free for a controller. While another client holds the lease, the command is refused with its name.
  std::string set_input(std::size_t part, std::size_t port, double value);
  std::string set_parameter(std::size_t part, const std::string& name, const ParameterValue& value);
  std::string write_blackboard(std::size_t part, const std::string& name, std::span<const std::byte> data);

 private:
  std::string under_lease(std::size_t part, const std::function<void(Part&)>& command);

  Client client_;
  std::vector<Part> parts_;
};

}  // namespace visum::bridge
