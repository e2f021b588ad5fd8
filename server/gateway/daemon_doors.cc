#include "server/gateway/daemon_doors.h"

#include <spdlog/spdlog.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "server/gateway/playback.h"
#include "server/gateway/working_text.h"
#include "server/recording/flight_recorder.h"

namespace visum::gateway {
namespace {

std::size_t most_ports(const cycle::Simulation& simulation) {
  std::size_t most = 0;
  for (const auto& bound : simulation.parts()) most = std::max(most, bound.controller_inputs.size());
  return most;
}

std::vector<std::string> names_of(const PartTable& table) {
  std::vector<std::string> names;
  for (const auto& slot : table.slots) names.push_back(slot.part->description().name);
  return names;
}

StaticWorld shown_world(const cycle::Simulation& simulation, const DaemonOptions& options) {
  auto world = static_world(simulation);
  world.server = options.program + " " VISUM_VERSION;
  world.simulated = options.simulated;
  world.has_world = options.has_world;
  world.stuck_node = options.stuck_node;
  world.models = options.models;
  if (options.playback) world.steering_part = options.playback->name();
  return world;
}

std::function<void(Published&)> shown_by(const DaemonOptions& options) {
  if (!options.playback) return options.show;
  return [playback = options.playback](Published& published) { playback->show(published); };
}

protocol::WebOptions web_options(const HttpOptions& http, Web& web) {
  return {http.on ? &web : nullptr, http.port, http.any_if_taken, http.hosts};
}

}  // namespace

DaemonDoors::DaemonDoors(cycle::Simulation& the_simulation, const DaemonOptions& options,
                         std::atomic<bool>& stop, Gateway::Latest newest)
    : simulation(the_simulation),
      stopping(stop),
      iterations(options.iterations),
      wait(options.wait),
      show(shown_by(options)),
      abandoned(options.abandoned),
      flight(options.flight),
      profile(options.profile),
      playback(options.playback),
      mailbox(most_ports(simulation)),
      tick_side(simulation, mailbox, options.run_at_once, options.archive),
      buses(tick_side),
      gateway(shown_world(simulation, options),
              options.token_file.empty() ? Tokens() : Tokens(options.token_file), mailbox, tick_side.stops(),
              tick_side.pacer(), std::move(newest), buses, options.log),
      web(
          options.http.page.empty() ? PageFiles() : PageFiles(options.http.page), gateway,
          [this] { return server.refused(); }, options.playback),
      server({options.address, options.port, {}, web_options(options.http, web), options.tls}, gateway) {
  tick_side.serve_models(options.models, options.scenes);
  tick_side.refuse_scenes([this] {
    return buses.are_open() ? "the field buses of this scene are open, so no other scene can take its place: "
                              "start a server with that scene"
                            : std::string();
  });
  tick_side.on_parts_changed([this](const PartTable& table) {
    if (stop_door) stop_door->set_parts(names_of(table));
  });
  tick_side.on_change_ready([this] {
    mailbox.wake();
    server.notify();
  });
  if (playback)
    tick_side.play([this] { return playback->tick(); }, [this] { return playback->era(); });
  else
    open_stop_door(options);
}

// Without the door, emergency stops still come in sessions.
void DaemonDoors::open_stop_door(const DaemonOptions& options) {
  StopOrders orders(names_of(*tick_side.part_table()), gateway.tokens(), options.tls.given(),
                    tick_side.stops());
  try {
    stop_door.emplace(options.address, server.port(), std::move(orders));
  } catch (const std::runtime_error& error) {
    spdlog::warn("visum stop has to go through a session: {}", error.what());
  }
}

void DaemonDoors::open_buses(std::vector<bus::BusAddress> addresses, std::function<void()> wake) {
  if (playback) return;
  auto of_scene = bus::scene_buses(simulation.scene());
  addresses.insert(addresses.begin(), of_scene.begin(), of_scene.end());
  buses.open(simulation, addresses, std::move(wake));
}

void DaemonDoors::after_tick() {
  ++ticks_made;
  buses.after_tick();
}

void DaemonDoors::add_to_copy(Published& copy) const {
  copy.silent_stops = tick_side.silent_stops();
  copy.late_writes = tick_side.dropped_writes();
  if (flight) copy.dump = flight->dump();
  if (show) show(copy);
}

bool DaemonDoors::end_asked() const {
  return stopping.load(std::memory_order_relaxed) || gateway.shutdown_asked();
}

bool DaemonDoors::ended() const {
  return end_asked() || (iterations > 0 && ticks_made >= iterations);
}

// From the moment at which the tick is abandoned its thread touches nothing but the world.
void DaemonDoors::abandon(std::uint64_t tick, const std::function<void()>& say_goodbye) {
  const auto work = simulation.working().now();
  if (!abandoned || !simulation.working().abandon(tick)) return;
  std::vector<const hwparts::Part*> parts;
  for (const auto& bound : simulation.parts()) parts.push_back(bound.part.get());
  say_goodbye();
  buses.close();
  stop_door.reset();
  tick_side.close_recording();
  abandoned(working_text(work, parts, *simulation.work_texts()));
}

void sleep_until(std::chrono::steady_clock::time_point due) {
  // steady_clock is CLOCK_MONOTONIC.
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(due.time_since_epoch()).count();
  const timespec until{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace visum::gateway
