// A daemon lets in the clients that it should, and no others.
#include <gtest/gtest.h>

#include "tests/gateway/running_daemon.h"
#include "tests/support/temp_files.h"

namespace visum::gateway {
namespace {

using namespace protocol;

std::string token_file(const test::TempFiles& files) {
  const auto file = files.write("tokens", "observer looking-only-0001\nadmin    does-anything-0001\n");
  std::filesystem::permissions(file,
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  return file;
}

TEST(Doors, AnAddressBeyondLoopbackNeedsTokens) {
  cycle::Simulation simulation(
      scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml"));
  DaemonOptions options;
  options.address = "0.0.0.0";
  options.port = 0;
  EXPECT_THROW(Daemon(simulation, options), std::runtime_error);
}

TEST(Doors, TokensDecideTheRole) {
  const test::TempFiles files;
  DaemonOptions options;
  options.token_file = token_file(files);
  RunningDaemon daemon(scene::ClockKind::kLockstep, options);
  EXPECT_EQ(refusal_of([&] { daemon.connect("stranger"); }).code(), ErrorCode::kUnauthenticated);
  EXPECT_EQ(refusal_of([&] { daemon.connect("guesser", Role::kObserver, "looking-only-0002"); }).code(),
            ErrorCode::kUnauthenticated);
  EXPECT_EQ(daemon.connect("looker", Role::kAdmin, "looking-only-0001").welcome().role, Role::kObserver);
  EXPECT_EQ(daemon.connect("boss", Role::kAdmin, "does-anything-0001").welcome().role, Role::kAdmin);
}

TEST(Doors, WithoutATokenFileLoopbackGetsTheRoleItAsksFor) {
  RunningDaemon daemon(scene::ClockKind::kLockstep);
  EXPECT_EQ(daemon.connect("anyone", Role::kAdmin).welcome().role, Role::kAdmin);
  const auto welcome = daemon.connect("anyone", Role::kObserver).welcome();
  EXPECT_EQ(welcome.role, Role::kObserver);
  EXPECT_EQ(welcome.clock, "lockstep");
  EXPECT_TRUE(welcome.simulated);
}

TEST(Doors, ShutdownIsForAdminsAndEndsTheDaemonInGoodOrder) {
  for (const auto clock : {scene::ClockKind::kLockstep, scene::ClockKind::kRealtime}) {
    RunningDaemon daemon(clock);
    auto admin = daemon.connect("admin", Role::kAdmin);
    auto watcher = daemon.connect("watcher", Role::kObserver);
    admin.request(Shutdown{});
    const auto farewell = watcher.next(std::chrono::seconds(5));
    ASSERT_TRUE(farewell && std::holds_alternative<Event>(*farewell));
    EXPECT_EQ(std::get<Event>(*farewell).kind, "shutdown");
  }
}

}  // namespace
}  // namespace visum::gateway
