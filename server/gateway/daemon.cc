#include "server/gateway/daemon.h"

#include <sys/prctl.h>
#include <time.h>

#include <algorithm>
#include <exception>
#include <optional>
#include <stdexcept>
#include <thread>

#include "protocol/server.h"
#include "server/bus/buses.h"
#include "server/gateway/gateway.h"
#include "server/gateway/mailbox.h"
#include "server/gateway/playback.h"
#include "server/gateway/tick_side.h"
#include "server/gateway/web.h"
#include "server/recording/flight_recorder.h"
#include "server/world/exchange.h"

namespace visum::gateway {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kIdle{20};  // how soon stop() is noticed while no tick is due
constexpr std::chrono::milliseconds kNoTime{0};
constexpr std::chrono::milliseconds kPaceLook{1};       // sessions of a paced lockstep are served that often
constexpr std::chrono::microseconds kTickingLook{100};  // and those of a world that ticks as fast as it can
constexpr std::chrono::seconds kFarewell{2};            // for clients that read their last frames slowly

std::size_t most_ports(const cycle::Simulation& simulation) {
  std::size_t most = 0;
  for (const auto& bound : simulation.parts()) most = std::max(most, bound.controller_inputs.size());
  return most;
}

StaticWorld shown_world(const cycle::Simulation& simulation, const DaemonOptions& options) {
  auto world = static_world(simulation);
  world.simulated = options.simulated;
  world.has_world = options.has_world;
  world.stuck_node = options.stuck_node;
  if (options.playback) world.steering_part = options.playback->name();
  return world;
}

std::function<void(Published&)> shown_by(const DaemonOptions& options) {
  if (!options.playback) return options.show;
  return [playback = options.playback](Published& published) { playback->show(published); };
}

// steady_clock is CLOCK_MONOTONIC; an absolute time does not drift with the time that the call takes.
void sleep_until(Clock::time_point due) {
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(due.time_since_epoch()).count();
  const timespec until{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace

struct Daemon::Impl {
  Impl(cycle::Simulation& the_simulation, const DaemonOptions& options, std::atomic<bool>& stop)
      : simulation(the_simulation),
        stopping(stop),
        iterations(options.iterations),
        wait(options.wait),
        show(shown_by(options)),
        flight(options.flight),
        playback(options.playback),
        threaded(simulation.scene().clock == scene::ClockKind::kRealtime),
        paced(options.paced && simulation.scene().clock == scene::ClockKind::kLockstep),
        mailbox(most_ports(simulation)),
        tick_side(simulation, mailbox, options.run_at_once),
        gateway(shown_world(simulation, options),
                options.token_file.empty() ? Tokens() : Tokens(options.token_file), mailbox,
                tick_side.pacer(),
                [this]() -> const Published& { return threaded ? fresh_copy() : fresh_fill(); }),
        web(
            options.http.page.empty() ? PageFiles() : PageFiles(options.http.page), gateway,
            [this] { return server.refused(); }, options.playback),
        server({options.address, options.port, {}, web_options(options.http), options.tls}, gateway) {
    if (playback) tick_side.play([this] { return playback->tick(); }, [this] { return playback->era(); });
    if (!playback) open_buses(options.buses);  // nobody talks to what is long over
    if (threaded) publish(false);
  }

  void open_buses(std::vector<bus::BusAddress> addresses) {
    auto of_scene = bus::scene_buses(simulation.scene());
    addresses.insert(addresses.begin(), of_scene.begin(), of_scene.end());
    if (addresses.empty()) return;
    buses.emplace(simulation, addresses, [this] {
      if (threaded) return mailbox.wake();
      server.notify();
    });
    gateway.name_buses(buses->addresses());
    gateway.open_buses({[this](const auto& streams) { settle_buses(streams); },
                        [this] { return buses->said(); }, [this](auto& streams) { buses->fill_in(streams); },
                        [this](auto part, auto rule) { buses->open_gate(part, std::move(rule)); },
                        [this](auto part) { buses->close_gate(part); },
                        [this](auto part) { return buses->granted_tick(part); }});
  }

  // All that members' programs have written by now is obeyed and answered.
  void settle_buses(const std::vector<protocol::Stream>& streams) {
    if (!buses->settle(streams)) return;
    tick_side.start();
    tick_side.touch();
  }

  // Between ticks: what came over the buses. The first frame starts the time.
  void serve_buses() {
    if (!buses || !buses->serve()) return;
    tick_side.start();
    if (!threaded) tick_side.touch();
  }

  void wait_until(Clock::time_point due) {
    if (wait) return wait(due);
    if (!buses) return sleep_until(due);
    buses->serve_until(due);
  }

  // A recording is compared while there is nothing else to do, up to `until`.
  void compare_until(Clock::time_point until) {
    while (playback && comparing && Clock::now() < until) comparing = playback->compare();
  }

  void do_tick() {
    tick_side.tick();
    ++ticks_made;
    if (buses) buses->after_tick();
    if (!threaded) tick_side.give_back();
  }

  protocol::WebOptions web_options(const HttpOptions& http) {
    return {http.on ? &web : nullptr, http.port, http.any_if_taken, http.hosts};
  }

  // realtime: the sessions' thread takes the newest copy.
  const Published& fresh_copy() {
    exchange.refresh();
    return exchange.front();
  }

  // lockstep, free: one thread; the copy is made when somebody looks, and only if something happened since.
  const Published& fresh_fill() {
    if (inline_copy.tick != simulation.tick_count() || inline_copy.era != simulation.era() ||
        inline_version != tick_side.version() || inline_copy.fault.empty() == simulation.frozen()) {
      fill_copy(inline_copy);
      inline_version = tick_side.version();
    }
    return inline_copy;
  }

  void fill_copy(Published& copy) {
    (threaded ? fill : fill_unhashed)(copy, simulation, tick_side.pace());
    if (flight) copy.dump = flight->dump();
    if (show) show(copy);
  }

  // realtime: a copy for the sessions' thread, which is woken if it has something to send. Who is told that
  // something is done finds it done there.
  void publish(bool wake) {
    fill_copy(exchange.back());
    exchange.publish();
    tick_side.give_back();
    published_version = tick_side.version();
    if (wake) server.notify();
  }

  bool ended() const {
    return stopping.load(std::memory_order_relaxed) || gateway.shutdown_asked() ||
           (iterations > 0 && ticks_made >= iterations);
  }

  bool has_something_to_send() {
    return gateway.next_due() <= simulation.tick_count() || simulation.frozen() || tick_side.has_told();
  }

  void run_realtime();
  void tick_in_real_time();
  void run_inline();
  bool may_tick_inline();
  bool await_due();

  cycle::Simulation& simulation;
  std::atomic<bool>& stopping;
  const std::int64_t iterations;
  std::int64_t ticks_made = 0;  // the world's own count begins where it was rewound to
  const std::function<void(Clock::time_point)> wait;
  const std::function<void(Published&)> show;
  const recording::FlightRecorder* const flight;
  Playback* const playback;
  bool comparing = true;
  const bool threaded;
  const bool paced;
  Mailbox mailbox;
  TickSide tick_side;
  world::Exchange<Published> exchange;
  Published inline_copy;
  std::uint64_t inline_version = 0;
  bool is_paced_now = false;
  std::uint64_t published_version = 0;
  Gateway gateway;
  Web web;
  protocol::Server server;
  std::optional<bus::Buses> buses;  // gone first: its thread wakes the others
};

Daemon::Daemon(cycle::Simulation& simulation, const DaemonOptions& options) {
  if (!is_loopback(options.address) && options.token_file.empty())
    throw std::runtime_error("--listen " + options.address +
                             " is open to others than this machine: that needs --token-file");
  impl_ = std::make_unique<Impl>(simulation, options, stopping_);
}

Daemon::~Daemon() = default;

std::uint16_t Daemon::port() const {
  return impl_->server.port();
}

const bus::BusNames& Daemon::buses() const {
  static const bus::BusNames kNone;
  return impl_->buses ? impl_->buses->names() : kNone;
}

std::uint16_t Daemon::http_port() const {
  return impl_->server.http_port();
}

void Daemon::run() {
  impl_->server.start();
  if (impl_->threaded)
    impl_->run_realtime();
  else
    impl_->run_inline();
}

// The tick's thread. The sessions' thread is only ever notified, never waited for; and told of the end, also
// where that is an exception.
void Daemon::Impl::run_realtime() {
  prctl(PR_SET_TIMERSLACK, 1UL);
  std::thread sessions([this] { server.run(); });
  std::exception_ptr failure;
  try {
    tick_in_real_time();
  } catch (...) {
    failure = std::current_exception();
  }
  gateway.end();
  server.notify();
  server.stop();
  sessions.join();
  if (failure) std::rethrow_exception(failure);
}

void Daemon::Impl::tick_in_real_time() {
  auto& pacer = tick_side.pacer();
  bool was_running = false;
  while (!ended()) {
    tick_side.empty_mailbox();
    serve_buses();
    if (gateway.start_asked()) tick_side.start();
    const bool runs = tick_side.time_runs();
    if (runs && !was_running) pacer.restart(Clock::now());
    if (published_version != tick_side.version() || runs != was_running) publish(true);
    was_running = runs;
    if (!runs) {
      compare_until(Clock::now() + kIdle);
      mailbox.wait_for(playback && comparing ? kNoTime : kIdle);
      continue;
    }
    // A tick that is far off is waited for in pieces: commands are done meanwhile, and may change when it is.
    const auto until = std::min(pacer.due(), Clock::now() + kIdle);
    compare_until(until - kPaceLook);
    wait_until(until);
    if (until < pacer.due()) continue;
    tick_side.empty_mailbox();
    pacer.begin_tick(Clock::now());
    const auto version_before = published_version;
    do_tick();
    publish(has_something_to_send() || version_before != tick_side.version());
  }
}

bool Daemon::Impl::may_tick_inline() {
  if (gateway.start_asked()) tick_side.start();
  if (!tick_side.time_runs()) {
    gateway.end_waits();
    return is_paced_now = false;
  }
  if (simulation.scene().clock == scene::ClockKind::kFree) return true;
  const auto tick = simulation.tick_count();
  if (gateway.lets(tick, tick_side.stepping())) return await_due();
  is_paced_now = false;
  gateway.check_timeouts(tick);
  return false;
}

// False: the next tick's time has not come yet. Sessions are served meanwhile.
bool Daemon::Impl::await_due() {
  if (!paced && !gateway.has_dropped()) return true;
  auto& pacer = tick_side.pacer();
  if (!std::exchange(is_paced_now, true)) pacer.restart(Clock::now());
  const auto left = pacer.due() - Clock::now();
  if (left > kPaceLook) return false;
  if (left > Clock::duration::zero()) sleep_until(pacer.due());
  pacer.begin_tick(Clock::now());
  return true;
}

void Daemon::Impl::run_inline() {
  if (paced) prctl(PR_SET_TIMERSLACK, 1UL);
  auto now = Clock::now(), polled = now - kTickingLook;
  while (!ended()) {
    if (now - polled >= kTickingLook) {
      server.poll();
      polled = now;
    }
    const auto version = tick_side.version();
    tick_side.empty_mailbox();
    tick_side.give_back();
    // First of all the members learn of a reset: what they granted was of the era before.
    if (version != tick_side.version()) gateway.serve();
    serve_buses();
    if (gateway.follow_buses(simulation.tick_count())) gateway.serve();
    if (may_tick_inline()) {
      if (gateway.complete_writes()) tick_side.empty_mailbox();
      if (wait) wait(Clock::now());
      do_tick();
      now = tick_side.ticked_at();
      if (!has_something_to_send()) continue;
      gateway.serve();
      server.write();
    } else {
      gateway.serve();
      server.poll_for(is_paced_now ? kPaceLook : kIdle);
      now = polled = Clock::now();
    }
  }
  gateway.end();
  gateway.serve();
  server.stop();
  const auto patience = Clock::now() + kFarewell;
  while (!server.ended() && Clock::now() < patience) server.poll_for(kIdle);
}

}  // namespace visum::gateway
