// Record and replay: every input comes back at its tick, and every difference is found.
#include "server/recording/replay.h"

#include <gtest/gtest.h>

#include <sstream>

#include "hwparts/powercube/module_bus.h"
#include "protocol/recording/recording_file.h"
#include "server/recording/export_csv.h"
#include "server/recording/replayer.h"
#include "tests/recording/forge.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

// Something of every kind, over two resets of the clock.
void live(RecordedWorld& world) {
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  world.run(40);
  EXPECT_TRUE(world->add_body(kBall).done());
  world.run(20);
  EXPECT_TRUE(world
                  ->push({{world->model().find_body("ball"), {1.0, 0.5, 0.0}, {0.0, 0.0, 0.1}},
                          world->tick_count() + 15})
                  .done());
  const auto snapshot = world->take_snapshot();
  world.run(40);
  world->lose_controller(0);
  world.run(10);
  ASSERT_TRUE(world->restore_snapshot(snapshot).done());
  world->write_inputs(0, 1, std::vector{0.9});
  world.run(30);
  ASSERT_EQ(world->remove_body("ball").text(), "");
  world.run(5);
  world->reset();
  world.run(25);
}

TEST(Replay, GoesThroughTheSameBits) {
  RecordedWorld world;
  live(world);
  const auto hash = world->state_hash();
  const auto result = replay(world.finish());
  EXPECT_TRUE(result.equal) << result.difference.what << " at tick " << result.difference.tick;
  EXPECT_EQ(result.damage, "");
  EXPECT_EQ(result.ticks, 170u);
  EXPECT_EQ(result.inputs, 9u);
  EXPECT_EQ(result.last_hash, hash);
  EXPECT_EQ(result.header.scene, "two_link");
}

// The mesh lies outside of the folders above the model, so that only --package finds it.
TEST(Replay, FindsTheMeshesOfPackagesThatAnOptionNamed) {
  const test::TempFiles package, files;
  std::string stl = "solid s\n";
  for (const char* face :
       {"0 0 0 0 1 0 1 0 0", "0 0 0 1 0 0 0 0 1", "0 0 0 0 0 1 0 1 0", "1 0 0 0 1 0 0 0 1"}) {
    std::istringstream numbers(face);
    stl += "facet normal 0 0 0\nouter loop\n";
    for (std::string x, y, z; numbers >> x >> y >> z;) stl += "vertex " + x + " " + y + " " + z + "\n";
    stl += "endloop\nendfacet\n";
  }
  package.write("m.stl", stl + "endsolid s\n");
  files.write(
      "r.urdf",
      "<robot name='r'><link name='base'/><link name='arm'><inertial><mass value='1'/><inertia ixx='1' "
      "iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial><collision><geometry><mesh "
      "filename='package://pack/m.stl'/></geometry></collision></link><joint name='j' "
      "type='continuous'><parent link='base'/><child link='arm'/><axis xyz='0 1 0'/></joint></robot>");
  const auto file = files.write("s.yaml", "visum: 1\nmodels: [{name: r, file: r.urdf}]");
  scene::Options options;
  options.packages.given["pack"] = package.folder();
  const auto recorded = files.folder() / "run.mcap";
  {
    config::FilesNoted noted;
    cycle::Simulation simulation(scene::load_scene(file, options));
    Recorder recorder(simulation, Origin{noted.files, "", "", false, options.packages}, recorded);
    for (int i = 0; i < 20; ++i) simulation.tick();
  }
  EXPECT_TRUE(replay(recorded).equal);
  RecordingFile recording(recorded);
  Header without = recording.header();
  ASSERT_EQ(without.packages.size(), 1u);
  without.packages.clear();
  EXPECT_THROW(make_world(without, recording.take_files(), {}, {}), config::ConfigError);
}

hwparts::ActiveFault broken(const char* kind, const hwparts::NamedNumbers& numbers, std::int64_t until = 0) {
  std::string why;
  const auto fault = hwparts::make_fault(kind, numbers, why);
  EXPECT_TRUE(fault) << why;
  return {0, fault.value_or(hwparts::Fault{}), until};
}

// Chance is part of the bits: noise, what a network delays and loses, and which telegrams never arrive.
TEST(Replay, BreaksTheSameThingsByTheSameChance) {
  RecordedWorld world("amtec_arm.yaml");
  ASSERT_TRUE(world->inject(broken("encoder_noise", {{"joint", 2}, {"deviation", 1e-3}})).done());
  ASSERT_TRUE(world->inject(broken("network_delay", {{"ms", 3}, {"jitter_ms", 9}}, 70)).done());
  ASSERT_TRUE(world->inject(broken("network_loss", {{"share", 0.5}}, 90)).done());
  ASSERT_TRUE(world->inject(broken("bus_lost", {{"share", 0.5}})).done());
  for (int i = 0; i < 60; ++i) {
    world->write_inputs(0, 0, std::vector{0.005 * i});
    powercube::Telegram there{powercube::Telegram::Kind::kSet, 3, {0x0B, 0x04}};
    powercube::put_value(there.message, 0.005f * static_cast<float>(i));
    world->handle_telegram(0, there, powercube::BusFraming::kSerial);
    world.run(2);
  }
  world->clear_faults(0, hwparts::FaultKind::kEncoderNoise, 1);
  world->clear_faults(0, hwparts::FaultKind::kEncoderNoise, 1);  // nothing is left to clear: no input
  world.run(10);
  EXPECT_EQ(world->faults().size(), 1u) << "two were over by themselves";
  world->reset();
  world.run(10);
  EXPECT_TRUE(world->faults().empty());
  const auto hash = world->state_hash();
  const auto result = replay(world.finish());
  EXPECT_TRUE(result.equal) << result.difference.what << " at tick " << result.difference.tick;
  EXPECT_EQ(result.inputs, 4u + 2 * 60u + 1u + 1u);
  EXPECT_EQ(result.last_hash, hash);
}

// A snapshot also decides which telegrams are lost next, and what becomes of the modules' answers.
TEST(Replay, ARestoredWorldGoesOnByTheSameChance) {
  RecordedWorld world("amtec_arm.yaml");
  ASSERT_TRUE(world->inject(broken("bus_lost", {{"share", 0.5}})).done());
  ASSERT_TRUE(world->inject(broken("bus_doubled", {{"share", 0.3}})).done());
  ASSERT_TRUE(world->inject(broken("bus_corrupted", {{"share", 0.2}})).done());
  const auto go_on = [&] {
    std::string fates;
    for (int i = 0; i < 30; ++i) {
      powercube::Telegram there{powercube::Telegram::Kind::kSet, 3, {0x0B, 0x04}};
      powercube::put_value(there.message, 0.005f * static_cast<float>(i));
      const bool answered = world->handle_telegram(0, there, powercube::BusFraming::kSerial).has_value();
      const auto& passage = world->parts()[0].part->modules()->passage();
      fates += answered ? static_cast<char>('a' + passage.lost + 2 * passage.doubled + 4 * passage.corrupted)
                        : '-';
      world.run(2);
    }
    return std::pair(world->state_hash(), fates);
  };
  go_on();
  const auto snapshot = world->take_snapshot();
  const auto once = go_on();
  ASSERT_TRUE(world->restore_snapshot(snapshot).done());
  EXPECT_EQ(go_on(), once);
  // A fault elsewhere does not change the chance of the bus.
  ASSERT_TRUE(world->restore_snapshot(snapshot).done());
  EXPECT_TRUE(world->inject(broken("encoder_stuck", {{"joint", 7}}, 1)).done());
  const auto result = replay(world.finish());
  EXPECT_TRUE(result.equal) << result.difference.what << " at tick " << result.difference.tick;
}

// Writes that were under way when their controller was lost do not arrive any more.
TEST(Replay, NothingComesFromALostController) {
  RecordedWorld world("amtec_arm.yaml");
  const auto before = world->parts()[0].controller_inputs;
  ASSERT_TRUE(world->inject(broken("network_delay", {{"ms", 50}})).done());
  world->write_inputs(0, 0, std::vector{0.2});
  world.run(10);
  world->lose_controller(0);
  world.run(100);
  EXPECT_EQ(world->parts()[0].controller_inputs, before);
  const auto result = replay(world.finish());
  EXPECT_TRUE(result.equal) << result.difference.what << " at tick " << result.difference.tick;
}

TEST(Replay, HoldsWithTheOtherEngineToo) {
  RecordedWorld world("two_link.yaml", "impulse");
  live(world);
  const auto result = replay(world.finish());
  EXPECT_TRUE(result.equal) << result.difference.what << " at tick " << result.difference.tick;
  EXPECT_EQ(result.header.build.engines, std::vector<std::string>{"impulse"});
}

TEST(Replay, NeedsNoneOfTheFilesThatTheSceneWasMadeOf) {
  test::TempFiles files;
  const auto scene = files.write("scene.yaml", "visum: 1\ninclude: [world.yaml]\n");
  files.write("world.yaml", "visum: 1\nbodies:\n  - {name: box, mass: 1, shapes: [{box: [1, 1, 1]}]}\n");
  {
    config::FilesNoted noted;
    cycle::Simulation simulation(scene::load_scene(scene));
    Recorder recorder(simulation, {noted.files, ""}, files.folder() / "run.mcap");
    for (int i = 0; i < 10; ++i) simulation.tick();
  }
  std::filesystem::remove(scene);
  std::filesystem::remove(files.folder() / "world.yaml");
  EXPECT_EQ(replay(files.folder() / "run.mcap").ticks, 10u);
}

TEST(Replay, ShowsTheFirstTickThatDiffersWithItsPorts) {
  RecordedWorld world;
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  world.run(50);
  world->write_inputs(0, 0, std::vector{0.1, 0.1});
  world.run(30);
  const auto forged = world.files().folder() / "forged.mcap";
  forge(world.finish(), forged, "/inputs", 1, [](std::vector<std::byte>& data) {
    data.clear();
    const std::vector values{0.1, 0.1000001};
    encode(TimedInput{50, 1, WriteInputs{"robot", 0, values}}, data);
  });
  const auto result = replay(forged);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.ticks, 50u);
  EXPECT_EQ(result.difference.tick, 51);
  EXPECT_EQ(result.difference.what, "the state is another one");
  EXPECT_NE(result.difference.recorded_hash, result.difference.replayed_hash);
  ASSERT_FALSE(result.difference.ports.empty());
  EXPECT_EQ(result.difference.ports[0].part, "robot");
  EXPECT_EQ(result.difference.ports[0].port, "Desired Angle 2");
  EXPECT_EQ(result.difference.ports[0].recorded, 0.1);
  EXPECT_EQ(result.difference.ports[0].replayed, 0.1000001);
}

struct BadInput {
  const char* name;
  Input input;
  const char* reason;
};
void PrintTo(const BadInput& input, std::ostream* out) {
  *out << input.name;
}
class ReplayOfABadInput : public testing::TestWithParam<BadInput> {};
const double kNaN[] = {std::numeric_limits<double>::quiet_NaN()};
const std::int32_t kNinetyNine[] = {99}, kFirst[] = {0};
const double kHuge[] = {1e300};
const double kOnes[] = {1.0};

TEST_P(ReplayOfABadInput, IsRefusedWithAReason) {
  RecordedWorld world;
  world->write_inputs(0, 0, std::vector{0.7});
  world.run(5);
  const auto forged = world.files().folder() / "forged.mcap";
  forge(world.finish(), forged, "/inputs", 0, [](std::vector<std::byte>& data) {
    data.clear();
    encode(TimedInput{0, 1, GetParam().input}, data);
  });
  const auto result = replay(forged);
  EXPECT_FALSE(result.equal);
  EXPECT_EQ(result.ticks, 0u);
  EXPECT_NE(result.difference.what.find(GetParam().reason), std::string::npos) << result.difference.what;
}

INSTANTIATE_TEST_SUITE_P(
    All, ReplayOfABadInput,
    testing::Values(
        BadInput{"NaN", WriteInputs{"robot", 0, kNaN}, "takes no"},
        BadInput{"OutOfRange", WriteInputs{"robot", 0, kHuge}, "takes no"},
        BadInput{"NoSuchPort", WriteInputs{"robot", 4'000'000'000u, kOnes}, "controller inputs"},
        BadInput{"NoSuchPart", LoseController{"nobody"}, "no part 'nobody'"},
        BadInput{"NoBody", PushBody{99, {}, {}, 5}, "no body number 99"},
        BadInput{"NegativeBody", PushBody{-1, {}, {}, 5}, "no body number -1"},
        BadInput{"SetNoBody", SetBody{99}, "no body number 99"},
        BadInput{"SetToNoQuaternion", SetBody{1, true, {0, 0, 0, 0, 0, 0, 0}}, "not of unit length"},
        BadInput{"SetNoJoint", SetJoints{kNinetyNine, kNaN, kNaN}, "no joint number 99"},
        BadInput{"SetJointToNaN", SetJoints{kFirst, kNaN, kNaN}, "not finite"},
        BadInput{"PullNoBody", PullBody{-1, {}, {}, 1.0}, "no body number -1"},
        BadInput{"PullWithoutForce", PullBody{0, {}, {}, 0.0}, "must be finite"},
        BadInput{"ReleaseNothing", ReleaseBody{0}, "nobody pulls"},
        BadInput{"PushOfNaN", PushBody{0, {kNaN[0], 0, 0}, {}, 5}, "must be finite"},
        BadInput{"NoSnapshot", RestoreSnapshot{7}, "no snapshot 7"},
        BadInput{"OtherSnapshot", TakeSnapshot{7}, "is number 1"},
        BadInput{"BadYaml", AddBody{"{name: ["}, "refused"},
        BadInput{"NoSuchName", RemoveBody{"nobody"}, "no body 'nobody'"},
        BadInput{"NoFaultPart", InjectFault{"nobody", "part_silent", {}, 0}, "no part 'nobody'"},
        BadInput{"NoFaultKind", InjectFault{"robot", "flat_tyre", {}, 0}, "no fault 'flat_tyre'"},
        BadInput{"NoFaultNumbers", InjectFault{"robot", "network_loss", {}, 0}, "has 1 numbers"},
        BadInput{"FaultOfNaN", InjectFault{"robot", "network_loss", kNaN, 0}, "finite"},
        BadInput{"FaultOfNobody", InjectFault{"robot", "sensor_off", {}, 0}, "no sensor"},
        BadInput{"FaultUntilBefore", InjectFault{"robot", "part_silent", {}, -1}, "cannot end at tick -1"},
        BadInput{"NoFaultToClear", ClearFault{"robot", "flat_tyre", 0}, "no fault 'flat_tyre'"},
        BadInput{"NoParameter", SetParameter{"robot", "No Such", 1.0}, "refused"},
        BadInput{"NoBlackboard", WriteBlackboard{"robot", "none", 0, {}}, "no blackboard 'none'"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(Replay, AFileThatWasCutShortIsComparedUpToItsLastWholeRecord) {
  RecordedWorld world;
  world->write_inputs(0, 0, std::vector{0.7, -0.3});
  world.run(400);
  const auto whole = bytes_of_file(world.finish());
  std::uint64_t most = 0;
  for (std::size_t size = 0; size <= whole.size(); size += whole.size() / 20) {
    const auto cut = world.files().write("cut.mcap", whole.substr(0, size));
    try {
      const auto result = replay(cut);
      EXPECT_TRUE(result.equal) << "cut at " << size << ": " << result.difference.what;
      EXPECT_GE(result.ticks, most);
      most = result.ticks;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(most, 0u) << "no header: " << error.what();
    }
  }
}

// A chunk whose kind is damaged looks like a record of a kind to come, which readers skip: its ticks are
// missed all the same.
TEST(Replay, AMissingChunkIsNoticed) {
  RecordedWorld world("amtec_arm.yaml");
  world.run(4000);
  auto bytes = bytes_of_file(world.finish());
  std::size_t chunks = 0;
  for (std::size_t at = 8; at + 9 < bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes[at + 1], 8);
    if (bytes[at] == 0x06 && ++chunks == 3) bytes[at] = 0x56;
    at += 9 + length;
  }
  ASSERT_GE(chunks, 4u);
  const auto result = replay(world.files().write("hole.mcap", bytes));
  EXPECT_TRUE(result.equal);
  EXPECT_LT(result.ticks, 3000u);
  EXPECT_NE(result.damage.find("are missing"), std::string::npos) << result.damage;
}

TEST(Replay, WhatIsNoRecordingIsRefused) {
  test::TempFiles files;
  const auto why_not = [&](const std::filesystem::path& file) {
    try {
      replay(file);
    } catch (const config::ConfigError& error) {
      return std::string(error.what()).substr(files.folder().string().size() + 1);
    }
    return std::string("nothing wrong");
  };
  EXPECT_EQ(why_not(files.folder() / "none.mcap"), "none.mcap: cannot be opened");
  EXPECT_EQ(why_not(files.write("a.mcap", "hello")),
            "a.mcap: it has no header: byte 0: this is no MCAP file");
}

TEST(RecordingFile, APartMayHaveTheNameDescription) {
  test::TempFiles files;
  const auto scene = files.write("scene.yaml",
                                 "visum: 1\nbodies: [{name: box, mass: 1, shapes: [{box: [1, 1, 1]}]}]\n"
                                 "sensors: [{name: description, kind: imu, body: box}]\n");
  const auto file = files.folder() / "run.mcap";
  {
    config::FilesNoted noted;
    cycle::Simulation simulation(scene::load_scene(scene));
    Recorder recorder(simulation, {noted.files, ""}, file);
    for (int i = 0; i < 10; ++i) simulation.tick();
  }
  const auto result = replay(file);
  EXPECT_EQ(result.damage, "");
  EXPECT_EQ(result.ticks, 10u);
  std::ostringstream csv;
  EXPECT_EQ(export_csv(file, {{"description"}}, csv).rows, 10u);
}

}  // namespace
}  // namespace visum::recording
