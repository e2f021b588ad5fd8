// The pieces that both loops of the daemon run: the two sides of the gateway, the server and the buses.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "protocol/server.h"
#include "server/gateway/daemon.h"
#include "server/gateway/daemon_buses.h"
#include "server/gateway/gateway.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/tick_side.h"
#include "server/gateway/web.h"

namespace visum::gateway {

// Binds the ports and opens the buses, but runs nothing: that is the loop's work, which owns it. `server`,
// `gateway` and `web` belong to the sessions' thread, everything else to the tick's.
struct DaemonDoors {
  // `newest` gives the copy of the world that sessions are answered from; see Gateway::Latest. Throws what
  // Daemon's constructor throws.
  DaemonDoors(cycle::Simulation& the_simulation, const DaemonOptions& options, std::atomic<bool>& stop,
              Gateway::Latest newest);
  ~DaemonDoors() { buses.close(); }  // first of all: its thread wakes the others
  DaemonDoors(const DaemonDoors&) = delete;
  DaemonDoors& operator=(const DaemonDoors&) = delete;

  // Opens the buses of the scene and of the options. A recording has none: its past cannot be talked to.
  void open_buses(std::vector<bus::BusAddress> addresses, std::function<void()> wake);
  // The world's tick, and what the buses have to say after it.
  void tick();
  // Completes a copy of the world with what the simulation does not know.
  void add_to_copy(Published& copy) const;
  bool ended() const;
  // True if the sessions have to be served after this tick.
  bool has_something_to_send() {
    return gateway.next_due() <= simulation.tick_count() || simulation.frozen() || tick_side.has_told();
  }

  cycle::Simulation& simulation;
  std::atomic<bool>& stopping;
  const std::int64_t iterations;
  std::int64_t ticks_made = 0;  // the world's own count does not serve: it goes back at a reset
  const std::function<void(std::chrono::steady_clock::time_point)> wait;  // empty: nothing else to wait for
  const std::function<void(Published&)> show;
  const recording::FlightRecorder* const flight;
  Playback* const playback;  // null: the world is a live one
  Mailbox mailbox;
  TickSide tick_side;
  DaemonBuses buses;
  Gateway gateway;
  Web web;
  protocol::Server server;
};

// Sleeps until an absolute time, which does not drift with the time that the call takes.
void sleep_until(std::chrono::steady_clock::time_point due);

}  // namespace visum::gateway
