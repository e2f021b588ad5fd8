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
#include "protocol/messages.h"

namespace visum::bridge {

class Plant {
 public:
  Plant(const std::string& address, const ClientOptions& options);

  Client& client() { return client_; }
  std::vector<Part>& parts() { return parts_; }
  std::vector<std::string> names() const;

  // Brings the ports of all parts up to date, with one wait.
  void refresh();

  // The modules that controllers have announced. Descriptions are left out where `known_revision` is the
  // server's.
  protocol::ModuleList modules(std::uint64_t known_revision);

  // Returns why set_input() would refuse the value for its range; it asks nobody.
  std::string check_input(std::size_t part, std::size_t port, double value) const;

  // Commands. Each returns the reason of the refusal, or an empty text once the server has accepted it.
  //
  // The lease is taken for the one command and released in good order, so that the value holds and the part
  // is free for a controller. While another client holds the lease, the command is refused with its name.
  std::string set_input(std::size_t part, std::size_t port, double value);
  // An `Emergency Stop` that becomes true goes past the session, as `visum stop` does: no cycle and no other
  // request delays it.
  std::string set_parameter(std::size_t part, const std::string& name, const ParameterValue& value);
  // Makes a sensor input of a controller's module hold a value, or releases it. Needs no lease.
  std::string override_module(const protocol::OverrideModulePort& wanted);
  // Changes a parameter of a controller's module. Needs no lease.
  std::string set_module_parameter(const protocol::SetModuleParameter& wanted);
  std::string write_blackboard(std::size_t part, const std::string& name, std::span<const std::byte> data);

 private:
  std::string stop(const std::string& part);
  std::string under_lease(std::size_t part, const std::function<void(Part&)>& command);

  const std::string address_;
  const ClientOptions options_;
  const std::string stop_token_;  // for stops that need no session
  Client client_;
  std::vector<Part> parts_;
};

}  // namespace visum::bridge
