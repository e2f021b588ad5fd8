// Writes the corpus of fuzz_world anew: write-world-corpus FOLDER. Each file is a course that real clients
// could cause, in one of the clocks.
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <string>

#include "tests/fuzz/world_input.h"

namespace {

using namespace visum::protocol;
using visum::testing::WorldInput;

constexpr unsigned kRealtime = 0, kLockstep = 1, kFree = 2;
constexpr std::size_t kObserver = 0, kFirst = 1, kSecond = 2, kAdmin = 3;  // sessions

constexpr const char* kRobot = R"(<robot name="post">
  <link name="base"/>
  <link name="stick">
    <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="stick"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="10"/>
  </joint>
</robot>
)";
constexpr const char* kCrate = R"(visum: 1
parameters: {name: crate}
bodies: [{name: "${name}", mass: 2, pose: {xyz: [0, 0, 0.5]}, shapes: [{box: [0.3, 0.3, 0.3]}]}]
sensors: [{name: "${name}_eye", kind: pose, body: "${name}", rate_hz: 100}]
)";
constexpr const char* kBrick =
    "{name: brick, mass: 0.5, pose: {xyz: [1, 1, 0.3]}, shapes: [{box: [0.2, 0.1, 0.1]}]}";

WorldInput drive() {
  WorldInput input(kRealtime);
  input.ask(kFirst, AcquireLease{"robot", 50'000'000}).ask(kObserver, Subscribe{"robot", 1}).tick(2);
  input.ask(kFirst, Write{"robot", 0, {0.3, 0.5}, 1}).tick(8);
  input.ask(kSecond, Write{"robot", 0, {0.1}, 1}).ask(kSecond, AcquireLease{"robot"});
  input.ask(kFirst, GetParameters{"robot"})
      .ask(kAdmin, SetParameter{"robot", "Supply Voltage", 20.0})
      .tick(8);
  input.ask(kObserver, SetParameter{"robot", "Emergency Stop", true}).tick(4);
  return input.ask(kFirst, ReleaseLease{"robot"})
      .ask(kAdmin, AcquireLease{"robot", 0, true})
      .tick(1)
      .leave(kAdmin, false)
      .tick(8);
}
WorldInput trajectory() {
  WorldInput input(kFree);
  input.ask(kFirst, AcquireLease{"robot"}).ask(kFirst, ReadBlackboard{"robot", "Trajectory"}).tick(1);
  input.ask(kFirst, LockBlackboard{"robot", "Trajectory", 500'000'000});
  input.ask(kFirst, WriteBlackboard{"robot", "Trajectory", 0, std::vector<std::byte>(64)});
  return input.ask(kFirst, UnlockBlackboard{"robot", "Trajectory"}).tick(8);
}
WorldInput spawn() {
  WorldInput input(kLockstep);
  input.ask(kObserver, ListModels{}).ask(kFirst, Join{}).ask(kFirst, Advance{40});
  input.ask(kAdmin, SpawnModel{"post.urdf", "second", {0, 2, 0, 1, 0, 0, 0}}).tick(4);
  input.ask(kObserver, ListParts{})
      .ask(kSecond, AcquireLease{"second"})
      .ask(kSecond, Write{"second", 0, {0.2}})
      .tick(4);
  input.ask(kAdmin, SpawnModel{"post.urdf", "second", {}, true}).tick(2).ask(kAdmin, RemoveModel{"second"});
  input.ask(kSecond, ReleaseLease{"second"}).ask(kAdmin, RemoveModel{"second"}).tick(2);
  return input.ask(kAdmin, Reset{visum::protocol::ResetScope::kSpawned}).tick(2);
}
WorldInput send_models() {
  WorldInput input(kFree);
  input.ask(kFirst, AcquireLease{"robot"});
  input.ask(kAdmin, SpawnModel{"post.urdf", "post", {2, 2, 0, 1, 0, 0, 0}, false, {{"post.urdf", kRobot}}})
      .tick(4);
  input.ask(kAdmin, SpawnModel{"crate.yaml", "crate", {0, 0, 1, 1, 0, 0, 0}, true, {{"crate.yaml", kCrate}}})
      .tick(4);
  input.ask(kObserver, DescribePart{"crate_eye"})
      .ask(kObserver, Read{"post"})
      .ask(kAdmin, TakeSnapshot{})
      .tick(4);
  return input.ask(kAdmin, RemoveModel{"post"})
      .ask(kAdmin, RestoreSnapshot{1})
      .ask(kAdmin, RemoveModel{"crate"})
      .tick(4);
}
WorldInput bodies() {
  WorldInput input(kRealtime);
  input.ask(kAdmin, Resume{}).ask(kAdmin, AddBody{kBrick}).tick(4).ask(kObserver, DescribeWorld{});
  input.ask(kAdmin, PushBody{"brick", {1, 0, 0}, {}, {}, 5'000'000}).tick(4);
  input.ask(kAdmin, SetBody{"brick", {1, 1, 2, 1, 0, 0, 0}, {0, 0, -1, 0, 0, 0}}).tick(4);
  input.ask(kAdmin, SetBody{"door", {}, {-1, 0, 0, 0, 0, 1}, true}).tick(8);
  return input.ask(kAdmin, RemoveBody{"brick"}).tick(2).leave(kAdmin, true).tick(4);
}
WorldInput pulls() {
  WorldInput input(kLockstep);
  input.ask(kFirst, Join{})
      .ask(kFirst, Advance{100})
      .ask(kAdmin, PullBody{"ball", {0, 0, 0.05}, {0.5, 0, 1}, 5.0, 20'000'000});
  input.tick(8).ask(kAdmin, PullBody{"ball", {}, {1, 0, 1}, 8.0, 0}).tick(8).ask(kAdmin, ReleaseBody{"ball"});
  input.ask(kAdmin, PullBody{"box", {}, {1, 0, 1}, 8.0, 0}).tick(4).leave(kAdmin, false).tick(4);
  return input.ask(kAdmin, SetJoints{"robot", {{"shoulder", 0.1, 0.0}, {"elbow", -0.2, 0.0}}}).tick(8);
}
WorldInput snapshots() {
  WorldInput input(kFree);
  input.ask(kFirst, AcquireLease{"robot"}).ask(kFirst, Write{"robot", 0, {0.3}}).tick(8);
  input.ask(kAdmin, TakeSnapshot{})
      .ask(kAdmin, TakeSnapshot{"monday"})
      .tick(8)
      .ask(kAdmin, RestoreSnapshot{1})
      .tick(2);
  input.ask(kAdmin, AddBody{kBrick}).tick(2).ask(kAdmin, RestoreSnapshot{0, "monday"}).tick(4);
  for (const auto scope : {ResetScope::kTime, ResetScope::kState, ResetScope::kWorld, ResetScope::kAll})
    input.ask(kAdmin, Reset{scope}).tick(2);
  return input;
}
WorldInput faults() {
  WorldInput input(kRealtime);
  input.ask(kFirst, AcquireLease{"robot"})
      .ask(kFirst, Write{"robot", 0, {0.3}})
      .ask(kObserver, ListFaults{"robot"});
  input.ask(kAdmin, InjectFault{"robot", "encoder_stuck", {{"joint", 1}}, 20'000'000}).tick(4);
  input.ask(kAdmin, InjectFault{"robot", "network_delay", {{"ms", 3}, {"jitter_ms", 1}}})
      .ask(kFirst, Write{"robot", 0, {0.1}})
      .tick(8);
  input.ask(kAdmin, InjectFault{"tracker", "sensor_frozen", {}})
      .ask(kAdmin, InjectFault{"robot", "torque_lost", {{"joint", 2}, {"share", 0.5}}});
  input.tick(8).ask(kAdmin, TakeSnapshot{}).tick(4).ask(kAdmin, RestoreSnapshot{1}).tick(4);
  return input.ask(kAdmin, ClearFault{"robot", "network_delay"}).ask(kAdmin, ClearFault{"robot"}).tick(4);
}
WorldInput lockstep() {
  WorldInput input(kLockstep);
  input.ask(kFirst, Join{1'000'000'000})
      .ask(kSecond, Join{0, 1, OnTimeout::kStop})
      .ask(kObserver, SubscribeWorld{2});
  input.ask(kFirst, Advance{5})
      .ask(kSecond, Advance{3})
      .tick(4)
      .ask(kSecond, Advance{10})
      .ask(kSecond, Note{"waits"})
      .tick(8);
  return input.ask(kAdmin, Pause{})
      .ask(kAdmin, Step{3})
      .tick(4)
      .ask(kAdmin, Resume{})
      .ask(kFirst, Leave{})
      .tick(4)
      .leave(kSecond, false)
      .tick(4);
}
WorldInput looks() {
  WorldInput input(kFree);
  input.ask(kObserver, Status{})
      .ask(kObserver, DescribeWorld{})
      .ask(kObserver, ReadWorld{})
      .ask(kObserver, ReadMesh{0});
  input.ask(kObserver, ReadTexture{0})
      .ask(kObserver, SubscribeEvents{EventLevel::kDebug})
      .ask(kFirst, Announce{"hello", "check"});
  input.ask(kFirst, AnnounceModules{"motion", 10'000'000, {{"Arm", false, {"a"}, {}, {"s"}}}})
      .ask(kFirst, ReportModules{"motion", 1, {{{0.5}, {}, {1.0}}}});
  input.ask(kSecond, OverrideModulePort{"motion", "Arm", "s", 0.25})
      .ask(kObserver, ListModules{})
      .ask(kObserver, Unsubscribe{"robot"});
  return input.ask(kObserver, ReadScenario{})
      .ask(kAdmin, RunScenario{"two_link_wave"})
      .ask(kAdmin, StopScenario{})
      .tick(1);
}
WorldInput recordings() {
  WorldInput input(kRealtime);
  input.ask(kAdmin, Resume{}).ask(kAdmin, StartRecording{"run"}).tick(4).ask(kAdmin, AddBody{kBrick}).tick(4);
  return input.ask(kAdmin, StartRecording{"run"})
      .ask(kAdmin, StopRecording{})
      .ask(kAdmin, SetSpeed{2.0})
      .tick(2)
      .ask(kAdmin, Shutdown{})
      .tick(1);
}

WorldInput load() {
  WorldInput input(kFree);
  input.ask(kObserver, ListScenes{})
      .ask(kFirst, AcquireLease{"robot"})
      .ask(kFirst, Write{"robot", 0, {0.2}})
      .tick(3);
  input.ask(kAdmin, SpawnModel{"crate.yaml", "crate"})
      .ask(kAdmin, PullBody{"box", {}, {1, 0, 1}, 8.0, 0})
      .tick(2);
  input.ask(kAdmin, LoadScene{"ramp"})
      .tick(4)
      .ask(kFirst, Write{"robot", 0, {0.1}})
      .ask(kObserver, ReadWorld{});
  input.ask(kAdmin, Resume{}).ask(kAdmin, PushBody{"box", {1, 0, 0}, {}, {}, 5'000'000}).tick(4);
  return input.ask(kAdmin, LoadScene{"fuzz_world"})
      .ask(kAdmin, RestoreSnapshot{1})
      .tick(4)
      .ask(kAdmin, Reset{ResetScope::kAll})
      .tick(2);
}

const std::map<std::string, std::function<WorldInput()>> kCourses{
    {"drive", drive},       {"trajectory", trajectory}, {"spawn", spawn},   {"send_models", send_models},
    {"bodies", bodies},     {"pulls", pulls},           {"faults", faults}, {"snapshots", snapshots},
    {"lockstep", lockstep}, {"looks", looks},           {"load", load},     {"recordings", recordings}};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write-world-corpus FOLDER\n";
    return 2;
  }
  std::filesystem::create_directories(argv[1]);
  for (const auto& [name, make] : kCourses) {
    const auto bytes = make().bytes();
    std::ofstream(std::filesystem::path(argv[1]) / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
}
