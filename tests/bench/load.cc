// visum-load: many observers and one controller, against a daemon in real time. It says whether anything was
// lost, and how late the daemon's ticks were. The exit code is 0 only if no client was disconnected and no
// command was lost.
#include <poll.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "protocol/client.h"
#include "tests/bench/percentiles.h"

namespace {

using namespace visum;
using namespace visum::protocol;
using Clock = std::chrono::steady_clock;

struct Options {
  std::string connect = "127.0.0.1:1500";
  std::string part = "arm";
  int observers = 64;
  double hz = 100.0;
  double seconds = 60.0;
  std::string json;  // a file; empty: none
};

struct Observed {
  std::uint64_t samples = 0;
  std::uint64_t conflated = 0;
  int disconnects = 0;
};

Connection connect_as(const Options& options, const std::string& name, Role role) {
  const auto [host, port] = parse_address(options.connect);
  return Connection(host, port, {1, 1, name, role, {}});
}

std::uint32_t period_ticks(const Connection& client, double hz) {
  return static_cast<std::uint32_t>(1e9 / hz / static_cast<double>(client.welcome().tick_ns) + 0.5);
}

// Reads all observers' samples on one thread, as they come.
Observed observe(const Options& options, std::vector<Connection>& observers, const std::atomic<bool>& ended,
                 bench::Percentiles& gaps) {
  Observed observed;
  std::vector<pollfd> waits;
  std::vector<Clock::time_point> last(observers.size(), Clock::now());
  for (auto& observer : observers) {
    observer.request(Subscribe{options.part, period_ticks(observer, options.hz)});
    waits.push_back({observer.native_handle(), POLLIN, 0});
  }
  while (!ended) {
    ::poll(waits.data(), waits.size(), 100);
    for (std::size_t i = 0; i < observers.size(); ++i) {
      if (waits[i].fd < 0 || !waits[i].revents) continue;
      try {
        while (const auto reply = observers[i].next(std::chrono::milliseconds(0))) {
          const auto* sample = std::get_if<PartSample>(&*reply);
          if (!sample) continue;
          ++observed.samples;
          observed.conflated = std::max(observed.conflated, sample->conflated);
          gaps.add(Clock::now() - std::exchange(last[i], Clock::now()));
        }
      } catch (const std::exception& error) {
        std::printf("observer %zu: %s\n", i, error.what());
        ++observed.disconnects;
        waits[i].fd = -1;
      }
    }
  }
  return observed;
}

struct Controlled {
  std::uint64_t commands = 0;
  std::uint64_t late = 0;  // sent so late in the period that it took effect in the next one only
  std::uint64_t lost = 0;  // taken by the server, and without effect even then
};

// Writes a vector each period, waits until the period has passed, and checks whether the vector is in force.
void control(Connection& client, const Options& options, bench::Percentiles& round_trips,
             Controlled& controlled) {
  const auto ticks = static_cast<std::int64_t>(period_ticks(client, options.hz));
  const auto until = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                        std::chrono::duration<double>(options.seconds));
  const auto start = client.request_as<PartSample>(Read{options.part}).controller_inputs;
  while (Clock::now() < until) {
    auto angles = std::vector(start.begin(), start.begin() + 7);
    angles[0] += 1e-3 * static_cast<double>(++controlled.commands % 100);
    const auto sent = Clock::now();
    client.request_as<Ok>(Write{options.part, 0, angles, controlled.commands});
    round_trips.add(Clock::now() - sent);
    const auto is_in_force = [&] {
      client.request_as<Advanced>(Advance{ticks});
      return client.request_as<PartSample>(Read{options.part}).controller_inputs[0] == angles[0];
    };
    if (is_in_force()) continue;
    ++(is_in_force() ? controlled.late : controlled.lost);
  }
}

using Figures = std::vector<std::pair<const char*, double>>;

Figures figures_of(const Options& options, const Observed& observed, const Controlled& controlled,
                   bench::Percentiles& round_trips, bench::Percentiles& gaps, const ServerStatus& status) {
  const auto number = [](auto value) { return static_cast<double>(value); };
  return {{"observers", number(options.observers)},
          {"hz", options.hz},
          {"seconds", options.seconds},
          {"disconnects", number(observed.disconnects)},
          {"samples", number(observed.samples)},
          {"conflated_max", number(observed.conflated)},
          {"commands", number(controlled.commands)},
          {"commands_late", number(controlled.late)},
          {"commands_lost", number(controlled.lost)},
          {"write_p50_us", round_trips.at(0.5)},
          {"write_p99_us", round_trips.at(0.99)},
          {"write_max_us", round_trips.at(1.0)},
          {"sample_gap_p50_us", gaps.at(0.5)},
          {"sample_gap_p99_us", gaps.at(0.99)},
          {"sample_gap_max_us", gaps.at(1.0)},
          {"ticks", number(status.tick)},
          {"overruns", number(status.overruns)},
          {"lateness_p50_us", number(status.lateness_p50_ns) * 1e-3},
          {"lateness_p99.9_us", number(status.lateness_p999_ns) * 1e-3},
          {"lateness_max_us", number(status.lateness_max_ns) * 1e-3}};
}

void write_json(const std::string& path, const Figures& figures) {
  std::ofstream file(path);
  file << "{";
  for (const auto& [name, value] : figures)
    file << (name == figures.front().first ? "" : ", ") << '"' << name << "\": " << value;
  file << "}\n";
  if (!file.flush()) throw std::runtime_error("cannot write '" + path + "'");
}

int run(const Options& options) {
  std::vector<Connection> observers;
  for (int i = 0; i < options.observers; ++i)
    observers.push_back(connect_as(options, "observer " + std::to_string(i), Role::kObserver));
  auto controller = connect_as(options, "load", Role::kController);
  controller.request(AcquireLease{options.part, 0, false});
  controller.request(Join{});

  std::atomic<bool> ended{false};
  const auto expected = static_cast<std::size_t>(options.hz * options.seconds);
  bench::Percentiles gaps(expected * observers.size() * 2), round_trips(expected * 2);
  Observed observed;
  std::thread watching([&] { observed = observe(options, observers, ended, gaps); });
  Controlled controlled;
  bool controller_stayed = true;
  try {
    control(controller, options, round_trips, controlled);
  } catch (const std::exception& error) {
    std::printf("controller: %s\n", error.what());
    controller_stayed = false;
  }
  ended = true;
  watching.join();

  const auto status = controller.request_as<ServerStatus>(Status{});
  controller.request(Leave{});
  controller.request(ReleaseLease{options.part});
  const auto figures = figures_of(options, observed, controlled, round_trips, gaps, status);
  for (const auto& [name, value] : figures) std::printf("%-24s %.1f\n", name, value);
  if (!options.json.empty()) write_json(options.json, figures);
  return controller_stayed && observed.disconnects == 0 && controlled.lost == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"visum-load: observers and a controller against a daemon in real time"};
  app.add_option("--connect", options.connect, "HOST:PORT")->capture_default_str();
  app.add_option("--part", options.part)->capture_default_str();
  app.add_option("--observers", options.observers)->capture_default_str()->check(CLI::Range(0, 500));
  app.add_option("--hz", options.hz, "of samples and commands")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1000.0));
  app.add_option("--seconds", options.seconds)->capture_default_str()->check(CLI::Range(0.1, 86400.0));
  app.add_option("--json", options.json, "write the figures to this file, too");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "visum-load: %s\n", error.what());
    return 1;
  }
}
