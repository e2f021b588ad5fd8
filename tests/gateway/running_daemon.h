// A real daemon on a loopback port of its own, run by a thread, for tests that talk to it as clients do.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "protocol/client.h"
#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"
#include "server/scene/scene.h"

namespace visum::gateway {

class RunningDaemon {
 public:
  explicit RunningDaemon(scene::ClockKind clock, DaemonOptions options = {}, double speed = 1.0)
      : RunningDaemon("amtec_arm.yaml", clock, std::move(options), speed) {}
  // `scene`: a file of models/scenes.
  RunningDaemon(const std::string& scene, scene::ClockKind clock, DaemonOptions options = {},
                double speed = 1.0)
      : simulation_(scene_of(scene, clock, speed)) {
    options.port = 0;
    daemon_ = std::make_unique<Daemon>(simulation_, options);
    thread_ = std::thread([this] { daemon_->run(); });
  }
  ~RunningDaemon() {
    daemon_->stop();
    thread_.join();
  }

  protocol::Connection connect(const std::string& name, protocol::Role role = protocol::Role::kController,
                               const std::string& token = {}) {
    return protocol::Connection("127.0.0.1", daemon_->port(), {1, 1, name, role, token});
  }
  std::uint16_t port() const { return daemon_->port(); }
  std::uint16_t http_port() const { return daemon_->http_port(); }
  const bus::BusNames& buses() const { return daemon_->buses(); }

 private:
  static scene::Scene scene_of(const std::string& file, scene::ClockKind clock, double speed) {
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes" / file);
    scene.clock = clock;
    scene.speed = speed;
    scene.lockstep_timeout_ns = 300'000'000;
    return scene;
  }
  cycle::Simulation simulation_;
  std::unique_ptr<Daemon> daemon_;
  std::thread thread_;
};

// The refusal that `action` provokes; fails the test where there is none.
template <typename Action>
protocol::RequestError refusal_of(Action action) {
  try {
    action();
  } catch (const protocol::RequestError& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was refused";
  return {protocol::ErrorCode::kUnspecified, ""};
}

// The index of a port by name; fails the test where there is none.
inline std::size_t index_of(const std::vector<protocol::Port>& ports, const std::string& name) {
  for (std::size_t i = 0; i < ports.size(); ++i)
    if (ports[i].name == name) return i;
  ADD_FAILURE() << "no port " << name;
  return 0;
}

inline protocol::PartDescription describe_arm(protocol::Connection& client) {
  return client.request_as<protocol::PartDescriptionReply>(protocol::DescribePart{"arm"}).description;
}

inline double sensor(protocol::Connection& client, const std::string& name) {
  const auto ports = describe_arm(client).sensor_outputs;
  return client.request_as<protocol::PartSample>(protocol::Read{"arm"})
      .sensor_outputs.at(index_of(ports, name));
}

inline protocol::Advanced advance(protocol::Connection& client, std::int64_t ticks) {
  return client.request_as<protocol::Advanced>(protocol::Advance{ticks});
}

inline std::uint64_t state_hash(protocol::Connection& client) {
  return client.request_as<protocol::ServerStatus>(protocol::Status{}).state_hash;
}

}  // namespace visum::gateway
