// Keeps which session moves which kinematic bodies and models, so that they stand still once it is gone. Its
// pulls end then, too.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/cycle/simulation.h"

namespace visum::gateway {

// Lives on the tick's thread, owned by the TickSide.
class Holders {
 public:
  // The session has set this body, or these joints, last. 0: they move on without a session.
  void note_body(std::uint64_t session, const std::string& body);
  void note_joints(std::uint64_t session, const std::vector<std::string>& joints);
  // The session is gone.
  void end(cycle::Simulation& simulation, std::uint64_t session);
  void clear() { held_.clear(); }

 private:
  static constexpr std::size_t kMost = 10'000;
  struct Held {
    std::uint64_t session;
    bool is_joint;
    std::string name;
  };
  void note(std::uint64_t session, bool is_joint, const std::string& name);
  std::vector<Held> held_;
};

}  // namespace visum::gateway
