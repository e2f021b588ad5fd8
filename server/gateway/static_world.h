// The facts about the world that the sessions' side knows without asking the tick's thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/cycle/simulation.h"
#include "server/gateway/part_table.h"
#include "server/gateway/stuck_node.h"
#include "server/gateway/world_view.h"

namespace visum::gateway {

// Made before the first session, and constant from then on but for scene and parts, which the Gateway renews
// on the sessions' thread when models come and go and when another scene is loaded. WorldRequests keeps the
// description that is valid now, and begins with `view`.
struct StaticWorld {
  std::string scene;
  scene::ClockKind clock = scene::ClockKind::kRealtime;
  std::int64_t tick_ns = 1'000'000;
  std::chrono::nanoseconds lockstep_timeout{};
  // By number of the gateway; without a name where none is. Only their const, any-thread functions are used.
  std::vector<const hwparts::Part*> parts;
  std::vector<std::string> agents;  // by part: the scene's agent that commands it; empty: none
  std::shared_ptr<const WorldView> view;
  bool simulated = true;
  bool has_world = true;                     // false: see DaemonOptions
  std::string steering_part{};               // of a recording that is shown; empty: the world is a live one
  std::function<StuckNode()> stuck_node{};   // empty: plug-ins are not watched
  std::string server{};                      // this program and its version, "visumd 0.2.0"
  const cycle::Working* working = nullptr;   // the simulation's
  std::shared_ptr<const PartTable> table{};  // of which `parts` and `agents` are
  std::filesystem::path models{};            // see DaemonOptions

  std::uint32_t generation(std::uint32_t part) const { return table->slots[part].generation; }
  // Takes over another table.
  void use(std::shared_ptr<const PartTable> other);
  const std::string& part_name(std::uint32_t part) const { return parts[part]->description().name; }
  // Rounded up.
  std::int64_t to_ticks(std::int64_t ns) const { return ns / tick_ns + (ns % tick_ns != 0); }
};

StaticWorld static_world(const cycle::Simulation& simulation);

}  // namespace visum::gateway
