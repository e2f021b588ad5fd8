// Scenes of the installation that an administrator loads into a server that runs, as its clients see it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <vector>

#include "server/gateway/scenario_files.h"
#include "server/gateway/scene_files.h"
#include "server/recording/archive.h"
#include "server/recording/replay.h"
#include "tests/gateway/running_daemon.h"
#include "tests/support/temp_files.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::filesystem::path kModels = std::filesystem::path(VISUM_SOURCE_DIR) / "models";
constexpr std::chrono::seconds kPatience{60};

DaemonOptions options() {
  DaemonOptions options;
  options.models = kModels;
  options.run_at_once = true;
  return options;
}

std::vector<std::string> parts(Connection& client) {
  std::vector<std::string> names;
  for (const auto& part : client.request_as<PartList>(ListParts{}).parts) names.push_back(part.name);
  return names;
}

// The events that came until one of this kind, which is among them.
std::vector<Event> events_until(Connection& client, const std::string& kind) {
  std::vector<Event> events;
  while (const auto item = client.next(kPatience)) {
    if (const auto* event = std::get_if<Event>(&*item)) events.push_back(*event);
    if (!events.empty() && events.back().kind == kind) return events;
  }
  ADD_FAILURE() << "no event " << kind;
  return events;
}

std::vector<std::string> kinds_of(const std::vector<Event>& events) {
  std::vector<std::string> kinds;
  for (const auto& event : events) kinds.push_back(event.kind);
  return kinds;
}

// The hash of a scene that is alone in a world, after so many ticks.
std::uint64_t hash_after(const std::string& scene, int ticks) {
  cycle::Simulation world(scene::load_scene(kModels / "scenes" / (scene + ".yaml")));
  for (int i = 0; i < ticks; ++i) world.tick();
  return world.state_hash();
}

// Writes a scene `many` of so many bodies.
void write_many(const test::TempFiles& files, int count) {
  std::string bodies = "visum: 1\nbodies:\n";
  for (int i = 0; i < count; ++i)
    bodies += "- {name: b" + std::to_string(i) + ", fixed: true, pose: {xyz: [" + std::to_string(i) +
              ", 0, 0]}, shapes: [{box: [0.5, 0.5, 0.5]}]}\n";
  files.write("scenes/many.yaml", bodies);
}

// The memory of this process.
std::size_t resident_bytes() {
  std::size_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

TEST(ScenesOfAServer, AreListedByNameForEveryRole) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, options());
  auto observer = daemon.connect("looks", Role::kObserver);
  const auto list = observer.request_as<SceneList>(ListScenes{});
  EXPECT_THAT(list.scenes,
              AllOf(Contains("amtec_arm"), Contains("cart"), Not(Contains(HasSubstr("textures")))));
  EXPECT_THAT(list.scenarios, AllOf(Contains("pick_and_place"), Not(Contains("amtec_arm"))));
}

TEST(ScenesOfAServer, AreFilesBelowItsFolder) {
  const test::TempFiles files;
  files.write("scenes/one.yaml", "");
  files.write("scenes/hall/two.yaml", "");
  files.write("scenes/robot.urdf", "");
  files.write("scenes/notes.txt", "");
  files.write("scenarios/test.yaml", "");
  files.write("other.yaml", "");
  EXPECT_THAT(scenes_in(files.folder()), ElementsAre("hall/two", "one", "robot.urdf"));
  EXPECT_THAT(scenarios_in(files.folder()), ElementsAre("test"));
  EXPECT_EQ(scene_file(files.folder(), "hall/two"), files.folder() / "scenes/hall/two.yaml");
  EXPECT_EQ(scene_file(files.folder(), "robot.urdf"), files.folder() / "scenes/robot.urdf");
  EXPECT_THAT(scenes_in(files.folder() / "none"), ElementsAre());
}

class LoadingInClock : public ::testing::TestWithParam<scene::ClockKind> {};

TEST_P(LoadingInClock, SessionsStayLeasesEndAndEverybodyIsTold) {
  RunningDaemon daemon(GetParam(), options());
  auto admin = daemon.connect("boss", Role::kAdmin);
  auto controller = daemon.connect("hand");
  auto observer = daemon.connect("looks", Role::kObserver);
  observer.request_as<EventList>(SubscribeEvents{});
  observer.request_as<Ok>(Subscribe{"arm", 1});
  controller.request_as<LeaseGrant>(AcquireLease{"arm"});
  const auto before = observer.request_as<ServerStatus>(Status{});
  admin.request_as<Ok>(LoadScene{"cart"});

  const auto events = events_until(observer, "load");
  ASSERT_THAT(kinds_of(events), AllOf(Contains("lease_lost"), Contains("era"), Contains("world_changed")));
  const auto text_of = [&](const std::string& kind) {
    return std::ranges::find(events, kind, &Event::kind)->text;
  };
  EXPECT_EQ(text_of("lease_lost"), "the part that 'hand' commanded went with its scene");
  EXPECT_EQ(text_of("era"), "the scene 'cart' was loaded");
  EXPECT_EQ(text_of("load"), "the scene 'cart' was loaded");
  EXPECT_EQ(events.back().source, "boss");
  const auto now = observer.request_as<ServerStatus>(Status{});
  EXPECT_EQ(now.era, before.era + 1);
  EXPECT_EQ(now.sessions, 3u);
  EXPECT_EQ(observer.request_as<WorldDescription>(DescribeWorld{}).scene, "cart");
  EXPECT_EQ(daemon.connect("late", Role::kObserver).welcome().scene, "cart");
  EXPECT_THAT(parts(controller), ElementsAre("cart"));
  EXPECT_EQ(refusal_of([&] {
              controller.request(Write{"arm", 0, {0.1}, 0});
            }).code(),
            ErrorCode::kUnknownName);
  EXPECT_EQ(refusal_of([&] { observer.request(Unsubscribe{"arm"}); }).code(), ErrorCode::kUnknownName);
  controller.request_as<LeaseGrant>(AcquireLease{"cart"});
  controller.request_as<Ok>(Write{"cart", 0, {0.1}, 0});
}

TEST(LoadingAScene, MembersOfTheLockstepStepWithTheNewWorldFromItsFirstTick) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, options());
  auto admin = daemon.connect("boss", Role::kAdmin);
  auto member = daemon.connect("steps");
  member.request_as<Advanced>(Join{60'000'000'000});
  advance(member, 40);
  for (const char* const scene : {"cart", "amtec_arm", "two_link", "cart"}) {
    SCOPED_TRACE(scene);
    admin.request_as<Ok>(LoadScene{scene});
    const auto now = advance(member, 100);
    EXPECT_EQ(now.tick, 100);
    EXPECT_EQ(state_hash(admin), hash_after(scene, 100));
  }
  EXPECT_EQ(admin.request_as<ServerStatus>(Status{}).lockstep.size(), 1u);
}

// The member asks for ticks while the scene is read: they are ticks of the new world.
TEST(LoadingAScene, TheLockstepWaitsForTheNewWorld) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, options());
  auto admin = daemon.connect("boss", Role::kAdmin);
  auto member = daemon.connect("steps");
  member.request_as<Advanced>(Join{60'000'000'000});
  advance(member, 40);
  const auto load = admin.send(LoadScene{"cart"});
  auto status = admin.send(Status{});  // answered behind the load
  admin.wait(load);
  EXPECT_EQ(std::get<ServerStatus>(admin.wait(status)).tick, 0);
  EXPECT_EQ(advance(member, 10).tick, 10);
}

TEST(LoadingAScene, InRealTimeTheOldWorldTicksOnUntilTheNewOneIsReady) {
  const test::TempFiles files;
  write_many(files, 3000);  // so that reading takes a while
  auto of_files = options();
  of_files.models = files.folder();
  RunningDaemon daemon(scene::ClockKind::kRealtime, of_files);
  auto admin = daemon.connect("boss", Role::kAdmin);
  auto observer = daemon.connect("looks", Role::kObserver);
  const auto load = admin.send(LoadScene{"many"});
  std::int64_t first = observer.request_as<ServerStatus>(Status{}).tick, last = first;
  while (!admin.wait_for(load, std::chrono::milliseconds(1)))
    if (const auto status = observer.request_as<ServerStatus>(Status{}); status.era == 1) last = status.tick;
  EXPECT_GT(last, first);
  EXPECT_EQ(observer.request_as<WorldDescription>(DescribeWorld{}).bodies.size(), 3000u);
}

class RefusedLoads : public ::testing::Test {
 protected:
  RefusedLoads() {
    files.write("scenes/broken.yaml", "visum: 1\nbodies:\n- {name: ball, mas: 1}\n");
    const auto arm = (kModels / "amtec_arm").string();
    files.write("scenes/with_bus.yaml", "visum: 1\nengine: impulse\nmodels: [{name: arm, file: " + arm +
                                            "/amtec_arm.urdf}]\nparts: [{name: arm, kind: amtec_arm, model: "
                                            "arm, drives: " +
                                            arm + "/drives.yaml, bus: 'tcp:0'}]\n");
    files.write("secret.yaml", "visum: 1\nbodies: []\n");
    of_files.models = files.folder();
  }
  std::string refusal(Connection& client, const std::string& scene) {
    const auto error = refusal_of([&] { client.request(LoadScene{scene}); });
    return std::string(to_string(error.code())) + ": " + error.what();
  }
  const test::TempFiles files;
  DaemonOptions of_files = options();
};

TEST_F(RefusedLoads, LeaveTheWorldAsItIs) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, of_files);
  auto admin = daemon.connect("boss", Role::kAdmin);
  auto controller = daemon.connect("hand");
  controller.request_as<LeaseGrant>(AcquireLease{"arm"});
  const auto hash = state_hash(admin);
  EXPECT_THAT(refusal(controller, "broken"), HasSubstr("forbidden"));
  EXPECT_THAT(refusal(admin, "brocken"), HasSubstr("did you mean 'broken'"));
  for (const char* const path :
       {"../secret", "../secret.yaml", "/etc/passwd", "", "scenes/broken", "./broken"})
    EXPECT_THAT(refusal(admin, path), HasSubstr("unknown name")) << path;
  EXPECT_THAT(refusal(admin, "broken"), AllOf(HasSubstr("bad value"), HasSubstr("broken.yaml:3")));
  EXPECT_THAT(refusal(admin, "with_bus"), AllOf(HasSubstr("wrong state"), HasSubstr("has field buses")));
  std::filesystem::remove(files.folder() / "scenes/broken.yaml");
  EXPECT_THAT(refusal(admin, "broken"), HasSubstr("unknown name")) << "the list is that of the moment";
  EXPECT_EQ(state_hash(admin), hash);
  EXPECT_EQ(admin.request_as<ServerStatus>(Status{}).era, 1u);
  controller.request_as<Ok>(Write{"arm", 0, {0.1}, 0});
}

TEST_F(RefusedLoads, OpenBusesKeepTheirScene) {
  const auto line = files.folder() / "arm.tty";
  of_files.models = kModels;
  of_files.buses = {{"arm", "pty", line.string(), {}}};
  RunningDaemon daemon(scene::ClockKind::kLockstep, of_files);
  auto admin = daemon.connect("boss", Role::kAdmin);
  EXPECT_THAT(refusal(admin, "cart"),
              AllOf(HasSubstr("wrong state"), HasSubstr("buses of this scene are open")));
}

TEST_F(RefusedLoads, ServersWithoutAWorldHaveNoScenes) {
  of_files.has_world = false;
  RunningDaemon daemon(scene::ClockKind::kRealtime, of_files);
  auto admin = daemon.connect("boss", Role::kAdmin);
  EXPECT_THAT(refusal(admin, "broken"), HasSubstr("no simulated world"));
  EXPECT_EQ(refusal_of([&] { admin.request(ListScenes{}); }).code(), ErrorCode::kWrongState);
}

// Two administrators at once: the one after the other, both whole.
TEST(LoadingAScene, TwoAtOnceComeOneAfterTheOther) {
  RunningDaemon daemon(scene::ClockKind::kRealtime, options());
  auto first = daemon.connect("first", Role::kAdmin), second = daemon.connect("second", Role::kAdmin);
  const auto one = first.send(LoadScene{"cart"}), other = second.send(LoadScene{"two_link"});
  first.wait(one);
  second.wait(other);
  const auto status = first.request_as<ServerStatus>(Status{});
  EXPECT_EQ(status.era, 3u);
  EXPECT_THAT(first.request_as<WorldDescription>(DescribeWorld{}).scene, AnyOf("cart", "two_link"));
}

// A scene of many bodies: a world that is left behind would take some 10 MB.
TEST(LoadingAScene, FiftyLoadsLeaveNothingBehind) {
  const test::TempFiles files;
  write_many(files, 300);
  auto of_files = options();
  of_files.models = files.folder();
  RunningDaemon daemon(scene::ClockKind::kLockstep, of_files);
  auto admin = daemon.connect("boss", Role::kAdmin);
  for (int i = 0; i < 10; ++i) admin.request_as<Ok>(LoadScene{"many"});
  const auto before = resident_bytes();
  for (int i = 0; i < 50; ++i) admin.request_as<Ok>(LoadScene{"many"});
  EXPECT_LT(resident_bytes(), before + (std::size_t{100} << 20));
  EXPECT_EQ(admin.request_as<ServerStatus>(Status{}).era, 61u);
}

// Commands whatever part there is, until `ended`. Returns how many writes were done.
int command_all_the_time(Connection client, const std::atomic<bool>& ended) {
  int writes = 0;
  while (!ended) {
    try {
      const auto part = parts(client).front();
      client.request(AcquireLease{part});
      for (; !ended; ++writes) client.request(Write{part, 0, {0.1}, 0});
    } catch (const RequestError& error) {
      EXPECT_THAT(error.code(), AnyOf(ErrorCode::kUnknownName, ErrorCode::kNoLease, ErrorCode::kBusy))
          << error.what();
    }
  }
  return writes;
}

TEST_P(LoadingInClock, ClientsThatCommandAndLookOnOutliveManyLoads) {
  RunningDaemon daemon(GetParam(), options());
  std::atomic<bool> ended{false};
  auto writes =
      std::async(std::launch::async, [&] { return command_all_the_time(daemon.connect("hand"), ended); });
  auto observer = daemon.connect("looks", Role::kObserver);
  observer.request_as<Ok>(SubscribeWorld{1});
  auto admin = daemon.connect("boss", Role::kAdmin);
  for (int i = 0; i < 20; ++i) {
    admin.request_as<Ok>(LoadScene{i % 2 == 0 ? "cart" : i % 4 == 1 ? "two_robots" : "amtec_arm"});
    const auto world = observer.request_as<WorldDescription>(DescribeWorld{});
    const auto sample = observer.request_as<WorldSample>(ReadWorld{});
    EXPECT_EQ(sample.poses.size(), 7 * world.bodies.size());
    EXPECT_EQ(sample.revision, world.revision);
    observer.request_as<PartSample>(Read{parts(observer).back()});
  }
  ended = true;
  EXPECT_GT(writes.get(), 20);
  EXPECT_EQ(admin.request_as<ServerStatus>(Status{}).era, 21u);
}

INSTANTIATE_TEST_SUITE_P(Each, LoadingInClock,
                         ::testing::Values(scene::ClockKind::kRealtime, scene::ClockKind::kLockstep,
                                           scene::ClockKind::kFree),
                         [](const auto& info) { return std::string(scene::name_of(info.param)); });

TEST(LoadingAScene, AStoppedPartOfTheOldSceneDoesNotStopOneOfTheNew) {
  RunningDaemon daemon(scene::ClockKind::kLockstep, options());
  auto admin = daemon.connect("boss", Role::kAdmin);
  auto observer = daemon.connect("looks", Role::kObserver);
  observer.request_as<Ok>(SetParameter{"arm", kEmergencyStop, true});
  admin.request_as<Ok>(LoadScene{"cart"});
  admin.request_as<Ok>(LoadScene{"amtec_arm"});
  const auto parameters = admin.request_as<ParameterList>(GetParameters{"arm"}).parameters;
  const auto stop = std::ranges::find(parameters, kEmergencyStop, &Parameter::name);
  ASSERT_NE(stop, parameters.end());
  EXPECT_EQ(stop->value, ParameterValue(false));
  EXPECT_EQ(state_hash(admin), hash_after("amtec_arm", 0));
}

// The recording that a client started goes on over the load.
TEST(LoadingAScene, IsInARecordingThatRuns) {
  const test::TempFiles files;
  recording::Origin origin;
  {
    config::FilesNoted noted;
    const cycle::Simulation same(scene::load_scene(kModels / "scenes/amtec_arm.yaml"));
    origin.files = std::move(noted.files);
  }
  recording::Archive archive(files.folder(), origin);
  auto with_archive = options();
  with_archive.archive = &archive;
  std::uint64_t hash = 0;
  {
    RunningDaemon daemon(scene::ClockKind::kLockstep, with_archive);
    auto admin = daemon.connect("boss", Role::kAdmin);
    auto member = daemon.connect("steps");
    member.request_as<Advanced>(Join{60'000'000'000});
    advance(member, 10);
    admin.request_as<Ok>(StartRecording{"run"});
    admin.request_as<SnapshotTaken>(TakeSnapshot{"arm"});
    advance(member, 100);
    admin.request_as<Ok>(LoadScene{"cart"});
    member.request_as<LeaseGrant>(AcquireLease{"cart"});
    member.request_as<Ok>(Write{"cart", 0, {0.2}, 0});
    advance(member, 100);
    EXPECT_THAT(refusal_of([&] {
                  admin.request(RestoreSnapshot{0, "arm"});
                }).what(),
                HasSubstr("another scene"));
    admin.request_as<SnapshotTaken>(TakeSnapshot{"cart"});
    advance(member, 50);
    admin.request_as<Ok>(RestoreSnapshot{0, "cart"});
    advance(member, 100);
    hash = state_hash(admin);
    admin.request_as<Ok>(StopRecording{});
  }
  const auto replayed = recording::replay(archive.recording_file("run"));
  EXPECT_TRUE(replayed.equal) << replayed.difference.what << " at tick " << replayed.difference.tick;
  EXPECT_EQ(replayed.ticks, 350u);
  EXPECT_EQ(replayed.last_hash, hash);
}

}  // namespace
}  // namespace visum::gateway
