// A plug-in's node whose call has not come back. Status shows it to clients.
#pragma once

#include <chrono>
#include <string>

namespace visum::gateway {

struct StuckNode {
  std::string node;                    // "agent 'explorer'"; empty: no call is stuck
  std::chrono::milliseconds since{0};  // how long the call has lasted
};

}  // namespace visum::gateway
