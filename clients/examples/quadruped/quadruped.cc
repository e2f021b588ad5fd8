// visum-quadruped: an example controller. It lets the robot of models/quadruped trot straight ahead and stop.
// It reads the legs and an IMU, and commands the joints 1000 times a second.
#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include "clients/cpp/visum.h"
#include "clients/examples/quadruped/walker.h"

namespace {

using namespace visum::quadruped;

constexpr int kDone = 0, kFailed = 1, kBadUsage = 2, kConnectionLost = 4, kInterrupted = 130;
constexpr double kStiffness = 100.0, kDamping = 2.0;  // N·m/rad, N·m·s/rad
constexpr double kImpedance = 3.0;                    // of the ports `Mode`
constexpr double kFallen = 0.5;                       // cosine of the trunk's tilt

struct Options {
  std::string connect = "127.0.0.1:1500", part = "legs", imu = "imu", token_file;
  Course course;
};

volatile std::sig_atomic_t stop_asked = 0;

void listen_to_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

// A vector of the part's ports for three joints a leg.
class ByLeg {
 public:
  explicit ByLeg(visum::Inputs ports) : ports_(std::move(ports)) {}
  void set(const std::array<Vector3d, kLegs>& values) {
    for (int i = 0; i < 3 * kLegs; ++i) {
      const visum::PortInfo& port = ports_.info(static_cast<std::size_t>(i));
      ports_.set(static_cast<std::size_t>(i), std::clamp(values[i / 3][i % 3], port.minimum, port.maximum));
    }
  }

 private:
  visum::Inputs ports_;
};

std::array<Vector3d, kLegs> by_leg(const visum::Outputs& ports) {
  std::array<Vector3d, kLegs> values;
  for (int i = 0; i < 3 * kLegs; ++i) values[i / 3][i % 3] = ports[static_cast<std::size_t>(i)];
  return values;
}

Vector3d vector(const visum::Outputs& ports) {
  return {ports[0], ports[1], ports[2]};
}

int walk(const Options& options) {
  visum::Client client(options.connect, {.name = "visum-quadruped", .token_file = options.token_file});
  visum::Part legs = client.part(options.part), imu = client.part(options.imu);
  legs.acquire();
  ByLeg angles(legs.inputs("Desired Angle")), speeds(legs.inputs("Desired Speed")),
      efforts(legs.inputs("Desired Effort"));
  const visum::Outputs actual = legs.outputs("Actual Angle"), turning = legs.outputs("Actual Speed");
  const visum::Outputs rate = imu.outputs("Angular Rate"), felt = imu.outputs("Acceleration");
  for (const auto& [group, value] :
       {std::pair{"Stiffness", kStiffness}, {"Damping", kDamping}, {"Mode", kImpedance}}) {
    visum::Inputs ports = legs.inputs(group);
    for (std::size_t i = 0; i < ports.size(); ++i) ports.set(i, value);
  }
  client.join();
  Walker walker(options.course);
  while (!walker.done() && stop_asked == 0) {
    const Commands commands = walker.cycle({by_leg(actual), by_leg(turning), vector(rate), vector(felt)});
    angles.set(commands.angles);
    speeds.set(commands.speeds);
    efforts.set(commands.efforts);
    legs.write();
    client.advance_ms(1e3 * kCycle);
    if (walker.motion().up().z() < kFallen) {
      std::fprintf(stderr, "visum-quadruped: the robot has fallen over\n");
      return kFailed;
    }
  }
  legs.release();
  std::printf("walked %.2f m\n", walker.motion().way());
  return stop_asked != 0 ? kInterrupted : kDone;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Lets a robot with four legs trot straight ahead, and stop. Its legs are one\n"
      "hardware part of ideal joints in mode impedance; an IMU on its trunk is another.");
  app.name("visum-quadruped");
  app.set_version_flag("--version", "visum-quadruped 0.2.0");
  app.add_option("--connect", options.connect, "server, HOST:PORT")->capture_default_str();
  app.add_option("--part", options.part, "name of the legs")->capture_default_str();
  app.add_option("--imu", options.imu, "name of the IMU")->capture_default_str();
  app.add_option("--token-file", options.token_file, "for a server that demands a token");
  app.add_option("--distance", options.course.distance, "how far to walk [m]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--speed", options.course.speed, "how fast [m/s]")
      ->check(CLI::Range(0.05, 0.6))
      ->capture_default_str();
  app.footer(
      "Example:\n  visum-quadruped --connect 127.0.0.1:1500 --distance 2 --speed 0.4\n\n"
      "Exit codes: 0 done, 1 failed or fallen, 2 bad usage, 4 connection lost,\n"
      "130 interrupted.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kBadUsage;
  }
  listen_to_signals();
  try {
    return walk(options);
  } catch (const visum::Error& error) {
    std::fprintf(stderr, "visum-quadruped: %s\n", error.what());
    const bool lost =
        error.code() == visum::ErrorCode::kConnection || error.code() == visum::ErrorCode::kTimeout;
    return lost ? kConnectionLost : kFailed;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "visum-quadruped: %s\n", error.what());
    return kFailed;
  }
}
