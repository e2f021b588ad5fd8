// An agent of a scene file, run as a client: in front of parts of a world, or of real ones. The same library,
// made in the same way, as inside the daemon.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "clients/agent/remote_link.h"
#include "protocol/config/config.h"
#include "protocol/plugin/library.h"

namespace visum::agent {

class RemoteAgent {
 public:
  // `entry`: of the scene's list `agents`. Throws ConfigError, and visum::Error where a part is not to be
  // had.
  RemoteAgent(Client& client, const config::Node& entry, const std::vector<plugin::Library>& libraries);
  ~RemoteAgent();

  std::int64_t period_ns() const { return period_ns_; }
  // One turn, at the client's time. Throws what the agent throws.
  void think(std::int64_t time_ns);
  // As it was made.
  void reset();
  void release();
  // "Way 12.3 m, Covered 20 m²"
  std::string outputs_in_words() const;

 private:
  class Context;

  std::int64_t period_ns_;
  std::vector<std::unique_ptr<RemoteLink>> links_;
  std::vector<plugin::Port> ports_;
  std::vector<double> outputs_;
  std::unique_ptr<plugin::Agent> agent_;
};

// The entry of this name, or the only one there is; and the libraries that the file names.
config::Node find_entry(const config::Node& root, const std::string& name);
std::vector<plugin::Library> open_libraries(const config::Node& root,
                                            const std::vector<std::filesystem::path>& folders);

}  // namespace visum::agent
