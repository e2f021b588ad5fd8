// The loop closed without a clock: the pick-and-place controller, unchanged and in lockstep, commands a part
// in front of modules on a bus, and the modules are those of the arm in the world with the box.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "hwparts/kinds/part_kinds.h"
#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"
#include "server/scene/scene.h"
#include "tests/hwparts/plugged_connection.h"

namespace visum {
namespace {

constexpr int kExchanges = 12;  // on the bus, per tick

scene::Scene load_arm() {
  return scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
}

scene::Scene only_the_part(const scene::Scene& whole) {
  scene::Scene scene;
  scene.name = whole.name;
  scene.world.tick_ns = whole.world.tick_ns;
  scene.parts = whole.parts;
  scene.clock = scene::ClockKind::kLockstep;
  return scene;
}

Eigen::Vector3d place_of(const cycle::Simulation& world, const std::string& body) {
  return world.state().bodies[world.model().find_body(body).index()].p_WC;
}

class ClosedLoop : public testing::TestWithParam<powercube::BusFraming> {};

TEST_P(ClosedLoop, ThePickAndPlaceControllerPutsTheBoxOnItsSpot) {
  cycle::Simulation world(load_arm());
  test::PluggedConnection* plugged = nullptr;
  const auto tick = [&] {
    world.tick();
    plugged->pass_tick();
  };
  test::PluggedConnection line(*world.parts()[0].part, GetParam(), tick, 0.001);
  plugged = &line;
  cycle::Simulation front(only_the_part(load_arm()),
                          [&](const std::string& kind, const hwparts::PartContext& context) {
                            return hwparts::make_real_part(kind, context, line, {true});
                          });
  gateway::DaemonOptions options;
  options.port = 0;
  options.simulated = options.has_world = false;
  options.wait = [&](auto) {
    tick();
    for (int i = 0; i < kExchanges; ++i) front.parts()[0].part->pump();
  };
  gateway::Daemon daemon(front, options);
  std::thread server([&] { daemon.run(); });
  const auto command = std::string(VISUM_BIN_DIR "/visum-pick-and-place --connect 127.0.0.1:") +
                       std::to_string(daemon.port()) +
                       " --urdf " VISUM_SOURCE_DIR "/models/amtec_arm/amtec_arm.urdf > /dev/null";
  EXPECT_EQ(std::system(command.c_str()), 0);
  daemon.stop();
  server.join();
  const Eigen::Vector3d off = place_of(world, "box") - place_of(world, "target");
  EXPECT_LT(off.head<2>().norm(), 0.01) << place_of(world, "box").transpose();
}

INSTANTIATE_TEST_SUITE_P(Wires, ClosedLoop,
                         testing::Values(powercube::BusFraming::kSerial, powercube::BusFraming::kCan),
                         [](const auto& info) {
                           return info.param == powercube::BusFraming::kCan ? "Can" : "Serial";
                         });

}  // namespace
}  // namespace visum
