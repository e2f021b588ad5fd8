// An agent of a scene file that runs as a client, in front of parts of a world or of real ones. It comes from
// the same library, and is made in the same way, as inside the daemon. One thread.
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
  // `entry` is one of the scene's list `agents`. Takes the leases of the parts that the agent commands.
  // `client` and `libraries` must outlive it. Throws ConfigError if the entry is wrong, visum::Error if a
  // part is missing or leased.
  RemoteAgent(Client& client, const config::Node& entry, const std::vector<plugin::Library>& libraries);
  ~RemoteAgent();

  std::int64_t period_ns() const { return period_ns_; }
  // One turn of the agent at `time_ns`, the simulated time since its start. Throws what the agent throws.
  void think(std::int64_t time_ns);
  void reset();    // back to the state after construction, for a world that was reset
  void release();  // gives the leases back
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

// The entry of this name; with an empty name, the only one there is. Throws ConfigError.
config::Node find_entry(const config::Node& root, const std::string& name);
// Opens the libraries that the file names in `plugins`. Throws ConfigError.
std::vector<plugin::Library> open_libraries(const config::Node& root,
                                            const std::vector<std::filesystem::path>& folders);

}  // namespace visum::agent
