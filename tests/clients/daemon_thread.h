// A real daemon with the arm's scene on a loopback port of its own, run by a thread, with the scene's own
// time-outs.
#pragma once

#include <filesystem>
#include <string>
#include <thread>

#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"
#include "server/scene/scene.h"

namespace visum {

class DaemonThread {
 public:
  explicit DaemonThread(scene::ClockKind clock, double speed = 1.0, std::uint16_t port = 0)
      : simulation_(load(clock, speed)),
        daemon_(simulation_, with_port(port)),
        thread_([this] { daemon_.run(); }) {}
  ~DaemonThread() {
    daemon_.stop();
    thread_.join();
  }

  std::uint16_t port() const { return daemon_.port(); }
  std::string address() const { return "127.0.0.1:" + std::to_string(port()); }

 private:
  static scene::Scene load(scene::ClockKind clock, double speed) {
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
    scene.clock = clock;
    scene.speed = speed;
    return scene;
  }
  static gateway::DaemonOptions with_port(std::uint16_t port) {
    gateway::DaemonOptions options;
    options.port = port;
    options.models = std::filesystem::path(VISUM_SOURCE_DIR) / "models";
    return options;
  }

  cycle::Simulation simulation_;
  gateway::Daemon daemon_;
  std::thread thread_;
};

}  // namespace visum
