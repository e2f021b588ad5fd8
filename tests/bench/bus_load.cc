// visum-bus-load: asks modules on a bus at a steady rate, as a driver's control loop does, and prints how
// long the answers take. Beside them it measures a bare echo over a line of the same kind, in turns with the
// modules, so that both meet the same machine. Example: visum-bus-load serial:arm.tty,38400 --rate 500
// --seconds 20
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <functional>
#include <memory>
#include <string>

#include "hwparts/powercube/asker.h"
#include "server/bus/host_connection.h"
#include "tests/bench/percentiles.h"
#include "tests/bench/pty_echo.h"
#include "tests/protocol/raw_echo.h"

namespace {

using namespace visum;

constexpr int kModules = 8;
constexpr std::uint8_t kPosition = 0x3C;

constexpr std::size_t kBytes = 10;  // of a frame

// A round trip without modules, over the same kind of line as `bus`.
std::function<void()> bare_echo(const std::string& bus) {
  if (bus.starts_with("tcp:")) {
    const auto server = std::make_shared<testing::RawEchoServer>(kBytes, kBytes);
    const auto client = std::make_shared<testing::RawEchoClient>(server->port(), kBytes, kBytes);
    return [server, client] { client->round_trip(); };
  }
  const auto pty = std::make_shared<bench::PtyEcho>(kBytes);
  return [pty] { pty->round_trip(); };
}

void print(const std::string& what, bench::Percentiles& times) {
  std::printf("%-40s %zu answers, p50 %.0f us, p99 %.0f us, p99.9 %.0f us, max %.0f us\n", what.c_str(),
              times.count(), times.at(0.5), times.at(0.99), times.at(0.999), times.at(1.0));
}

int measure(const std::string& bus, double rate, double seconds) {
  const auto line = bus::open_host_connection(bus);
  powercube::Asker asker(*line, {1'000'000'000, 1});
  const auto count = static_cast<std::size_t>(rate * seconds);
  const auto period_ns = static_cast<std::int64_t>(1e9 / rate);
  bench::Percentiles times(count), echoes(count);
  const auto echo = bare_echo(bus);
  std::size_t lost = 0;
  auto due = line->now_ns();
  const auto sleep_until = [&](std::int64_t time) {
    while (line->now_ns() < time) line->wait_until(time);
  };
  for (std::size_t i = 0; i < count; ++i, due += period_ns) {
    sleep_until(due);
    const auto asked = line->now_ns();
    const int module = static_cast<int>(i % kModules) + 1;
    const auto answer = asker.ask_and_wait(module, {powercube::command::kGetParameter, kPosition});
    if (!answer) ++lost;
    if (answer) times.add(std::chrono::nanoseconds(line->now_ns() - asked));
    sleep_until(due + period_ns / 2);
    const auto sent = line->now_ns();
    echo();
    echoes.add(std::chrono::nanoseconds(line->now_ns() - sent));
  }
  print(bus, times);
  print("a bare echo meanwhile", echoes);
  if (lost > 0) std::printf("%zu requests were lost\n", lost);
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
