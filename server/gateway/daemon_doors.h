// The pieces that both loops of the daemon run: the two sides of the gateway, the server and the buses.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "protocol/server.h"
#include "server/gateway/daemon.h"
#include "server/gateway/daemon_buses.h"
#include "server/gateway/gateway.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/stop_door.h"
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
  ~DaemonDoors() {  // first of all: their threads wake the others
    tick_side.end_changes();
    buses.close();
  }
  DaemonDoors(const DaemonDoors&) = delete;
  DaemonDoors& operator=(const DaemonDoors&) = delete;

  // Opens the buses of the scene and of the options. A recording has none: its past cannot be talked to.
  void open_buses(std::vector<bus::BusAddress> addresses, std::function<void()> wake);
  // A door of their own for emergency stops.
  void open_stop_door(const DaemonOptions& options);
  // To be called after each tick of the tick's side: serves the buses, and counts.
  void after_tick();
  // Ends the process without the tick that is being done; returns only if that is over, or may not be
  // abandoned. `say_goodbye` ends the sessions, within its own bound.
  void abandon(std::uint64_t tick, const std::function<void()>& say_goodbye);
  // Completes a copy of the world with what the simulation does not know.
  void add_to_copy(Published& copy) const;
  bool ended() const;
  bool end_asked() const;  // by a signal or a client; any thread
  // True if the sessions have to be served after this tick.
  bool has_something_to_send() {
    return gateway.next_due() <= simulation.tick_count() || simulation.frozen() || tick_side.has_told() ||
           gateway.has_to_warn(simulation.limited_ticks());
  }

  cycle::Simulation& simulation;
  std::atomic<bool>& stopping;
  const std::int64_t iterations;
  std::int64_t ticks_made = 0;  // the world's own count does not serve: it goes back at a reset
  const std::function<void(std::chrono::steady_clock::time_point)> wait;  // empty: nothing else to wait for
  const std::function<void(Published&)> show;
  const std::function<void(const std::string&)> abandoned;
  const recording::FlightRecorder* const flight;
  config::Profile* const profile;  // null: nobody measures
  Playback* const playback;        // null: the world is a live one
  Mailbox mailbox;
  TickSide tick_side;
  DaemonBuses buses;
  Gateway gateway;
  Web web;
  protocol::Server server;
  std::optional<StopDoor> stop_door;  // none: a recording is shown, or another program has the UDP port
};

// Sleeps until an absolute time, which does not drift with the time that the call takes.
void sleep_until(std::chrono::steady_clock::time_point due);

}  // namespace visum::gateway
