// The facts about the world that the sessions' side knows without asking the tick's thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/cycle/simulation.h"
#include "server/gateway/stuck_node.h"
#include "server/gateway/world_view.h"

namespace visum::gateway {

// Made before the first session, and constant from then on: any thread may read it. Bodies may come and go
// later; WorldRequests keeps the description that is valid now, and begins with `view`.
struct StaticWorld {
  std::string scene;
  scene::ClockKind clock = scene::ClockKind::kRealtime;
  std::int64_t tick_ns = 1'000'000;
  std::chrono::nanoseconds lockstep_timeout{};
  std::vector<const hwparts::Part*> parts;  // only their const, any-thread functions are used
  std::vector<std::string> agents;          // by part: the scene's agent that commands it; empty: none
  std::shared_ptr<const WorldView> view;
  bool simulated = true;
  bool has_world = true;                    // false: see DaemonOptions
  std::string steering_part{};              // of a recording that is shown; empty: the world is a live one
  std::function<StuckNode()> stuck_node{};  // empty: plug-ins are not watched
  std::string server{};                     // this program and its version, "visumd 0.2.0"
  const cycle::Working* working = nullptr;  // the simulation's

  const std::string& part_name(std::uint32_t part) const { return parts[part]->description().name; }
  // Rounded up.
  std::int64_t to_ticks(std::int64_t ns) const { return ns / tick_ns + (ns % tick_ns != 0); }
};

StaticWorld static_world(const cycle::Simulation& simulation);

}  // namespace visum::gateway
