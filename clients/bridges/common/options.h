// The options and the ready line that all bridges share.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/cpp/visum.h"

namespace CLI {
class App;
}

namespace visum::bridge {

struct Options {
  std::string connect = "127.0.0.1:1500";
  std::string token_file, tls_ca, tls_cert, tls_key;
  std::string listen = "127.0.0.1";
  int port = -1;  // -1: the bridge's usual port, or the next free one above
  bool no_authentication = false;
  bool json = false;
  bool lockstep = false;
  double period_ms = 10.0;
  std::vector<std::string> gates;

  ClientOptions client(const std::string& bridge) const;  // for the session with the server
};

// Adds the options to the bridge's app. `protocol` is the name of what its peers speak.
void declare(CLI::App& app, Options& options, const std::string& protocol);

// Throws cli::ExitError(kUsage) if the address is beyond loopback and the user has not said that this is
// meant: the peers' protocol asks nobody who they are.
void check_address(const Options& options, const std::string& protocol);

// Prints the one line that says that peers can connect.
void print_ready(const Options& options, const std::string& bridge, std::uint16_t port,
                 const std::vector<std::string>& parts);

}  // namespace visum::bridge
