// Runs storms over the session layer, seed after seed, and tells the first that breaks a promise, with the
// command line that runs it alone. In each fourth the servers record on a disk that fills.
//   session_storm [--seed N] [--seeds COUNT] [--seconds S] [--duration-ms D]
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <limits>

#include "tests/gateway/storm/full_disk.h"
#include "tests/gateway/storm/storm.h"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  std::uint64_t seed = 1, seeds = std::numeric_limits<std::uint64_t>::max();
  double seconds = std::numeric_limits<double>::infinity();
  std::int64_t duration_ms = 20'000;
  CLI::App app("Storms over the session layer: clients, connections and both threads from one seed");
  app.add_option("--seed", seed, "the first");
  app.add_option("--seeds", seeds, "so many at most");
  app.add_option("--seconds", seconds, "stops after so long, wall clock");
  app.add_option("--duration-ms", duration_ms, "of each storm, simulated");
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::off);
  const visum::storm::FullDisk disk;
  const auto began = Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
  visum::storm::Oracle::Counts sum;
  std::uint64_t done = 0, servers = 0;
  std::int64_t ticks = 0;
  for (; done < seeds && (done == 0 || passed() < seconds); ++done, ++seed) {
    const bool records = seed % 4 == 0;
    const auto outcome = visum::storm::run_storm(seed, duration_ms, records ? disk.file() : "");
    if (!outcome.broken.empty()) {
      std::printf("seed %llu: %s\n  %s --seed %llu --seeds 1 --duration-ms %lld\n", (unsigned long long)seed,
                  outcome.broken.c_str(), argv[0], (unsigned long long)seed, (long long)duration_ms);
      return 1;
    }
    sum.requests += outcome.counts.requests;
    sum.refused += outcome.counts.refused;
    sum.writes += outcome.counts.writes;
    sum.losses += outcome.counts.losses;
    servers += outcome.servers;
    ticks += outcome.ticks;
  }
  std::printf(
      "%llu seeds in %.1f s: %llu servers, %lld ticks, %llu requests, %llu refused, %llu writes accepted, "
      "%llu losses of a controller; every promise held\n",
      (unsigned long long)done, passed(), (unsigned long long)servers, (long long)ticks,
      (unsigned long long)sum.requests, (unsigned long long)sum.refused, (unsigned long long)sum.writes,
      (unsigned long long)sum.losses);
  return 0;
}
