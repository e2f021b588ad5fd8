// visum-bus-load: asks modules on a bus at a steady rate, as a driver's control loop does, and prints how
// long the answers take: visum-bus-load serial:arm.tty,38400 --rate 500 --seconds 20
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "hwparts/powercube/asker.h"
#include "server/gateway/bus/host_line.h"
#include "tests/bench/percentiles.h"

namespace {

using namespace visum;

constexpr int kModules = 8;
constexpr std::uint8_t kPosition = 0x3C;

int measure(const std::string& bus, double rate, double seconds) {
  const auto line = gateway::open_host_line(bus);
  powercube::Asker asker(*line, {1'000'000'000, 1});
  const auto count = static_cast<std::size_t>(rate * seconds);
  const auto period_ns = static_cast<std::int64_t>(1e9 / rate);
  bench::Percentiles times(count);
  std::size_t lost = 0;
  auto due = line->now_ns();
  for (std::size_t i = 0; i < count; ++i, due += period_ns) {
    while (line->now_ns() < due) line->wait_until(due);
    const auto asked = line->now_ns();
    const int module = static_cast<int>(i % kModules) + 1;
    const auto answer = asker.ask_and_wait(module, {powercube::command::kGetParameter, kPosition});
    if (!answer) ++lost;
    if (answer) times.add(std::chrono::nanoseconds(line->now_ns() - asked));
  }
  std::printf("%s: %zu answers, %zu lost, p50 %.0f us, p99 %.0f us, max %.0f us\n", bus.c_str(),
              times.count(), lost, times.at(0.5), times.at(0.99), times.at(1.0));
  return lost == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  std::string bus;
  double rate = 500.0, seconds = 20.0;
  CLI::App app{"visum-bus-load: how soon modules on a bus answer"};
  app.add_option("bus", bus, "as visum-hwpart's --bus")->required()->type_name("BUS");
  app.add_option("--rate", rate, "requests per second")->capture_default_str()->check(CLI::Range(1.0, 1e5));
  app.add_option("--seconds", seconds, "for so long")->capture_default_str()->check(CLI::Range(0.1, 3600.0));
  CLI11_PARSE(app, argc, argv);
  try {
    return measure(bus, rate, seconds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "visum-bus-load: %s\n", error.what());
    return 2;
  }
}
