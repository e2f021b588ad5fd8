// A copy of all that the sessions may see of the world, as of one tick border.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/collision/collision.h"
#include "server/cycle/phases.h"
#include "server/cycle/simulation.h"
#include "server/gateway/part_table.h"
#include "server/gateway/world_view.h"

namespace visum::gateway {

// The pace of time: paused or running, and how fast.
struct Pace {
  bool paused = true;
  double speed = 1.0;
  double real_time_factor = 0.0;
};

// Filled on the tick's thread, read on the sessions' thread. Its vectors keep their capacity, so that filling
// it does not allocate once warm.
struct Published {
  struct Part {
    std::vector<double> controller_inputs, sensor_outputs;
  };
  std::int64_t tick = 0;
  std::int64_t sim_time_ns = 0;
  std::uint64_t era = 0;
  std::uint64_t revision = 0;
  std::uint64_t state_hash = 0;                  // where `hashed_by` is null; 0: not known
  const cycle::Simulation* hashed_by = nullptr;  // still as this copy shows it, so its hash can be asked for
  std::string fault;                             // empty: not frozen
  std::string dump;  // the file with the ticks before it froze; empty: there is none
  Pace pace;
  std::vector<Part> parts;                 // by number of `table`
  std::shared_ptr<const PartTable> table;  // shared: a change of the world makes a new one
  std::vector<double> poses;               // 7 per body: x y z qw qx qy qz of the link frame
  std::vector<double> velocities;          // 6 per body
  std::vector<double> joint_positions, joint_velocities, joint_efforts, following_errors;
  std::vector<collision::Contact> contacts;
  std::vector<hwparts::ActiveFault> faults;
  cycle::Phases::Summary phases{};
  std::uint64_t solver_warnings = 0, limited_ticks = 0;
  std::vector<std::string> limited_bodies;          // names, of the last limited tick
  std::uint64_t silent_stops = 0, late_writes = 0;  // see ServerStatus
  std::shared_ptr<const cycle::FlightRing> ring;    // shared: a change of the world makes a new one
  std::shared_ptr<const std::vector<std::string>> work_texts;  // see Simulation; shared likewise
  std::shared_ptr<const WorldView> shown;  // the world of another server to show; null: this server's own
};

// Why the world is frozen, and which file holds the ticks before.
std::string frozen_reason(const Published& published);

// `table`: the numbers of the parts.
void fill(Published& published, const cycle::Simulation& simulation, const Pace& pace,
          const std::shared_ptr<const PartTable>& table);
// The same without the hash, which is then made when it is asked for. Only for readers on the tick's thread,
// and only until the next tick.
void fill_unhashed(Published& published, const cycle::Simulation& simulation, const Pace& pace,
                   const std::shared_ptr<const PartTable>& table);
std::uint64_t state_hash(const Published& published);

}  // namespace visum::gateway
