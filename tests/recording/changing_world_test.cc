// A world that is changed at random while it runs: the replay of its recording goes through the same bits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "server/recording/archive.h"
#include "server/recording/replay.h"
#include "tests/recording/recorded_world.h"

namespace visum::recording {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

// One random operation between two ticks. Refusals are as good as successes: neither may differ in a replay.
class Operator {
 public:
  explicit Operator(cycle::Simulation& world) : world_(world) {}

  void operate() {
    switch (below(16)) {
      case 0:
        return count(world_.set_body(body(), pose(), vector(1.0), vector(1.0)));
      case 1:
        return count(world_.set_body(body(), {}, vector(0.5), vector(0.5)));
      case 2:
      case 3:
        return set_joints();
      case 4:
      case 5:
        return count(world_.pull({body(), vector(0.1), vector(2.0) + Vector3d(0, 0, 2), 5 + 20 * share(),
                                  below(2) == 0 ? 0 : later(50)}));
      case 6:
        done_ += world_.release(body());
        return;
      case 7:
        return count(world_.push({{body(), vector(5.0), vector(1.0)}, later(20)}));
      case 8:
        if (below(8) != 0) return write();
        snapshots_.push_back(world_.take_snapshot());
        return;
      case 9:
        if (snapshots_.empty() || below(8) != 0) return write();
        return count(world_.restore_snapshot(snapshots_[below(snapshots_.size())]));
      case 10:
        if (below(40) != 0) return write();
        return count(world_.reset_now(static_cast<protocol::ResetScope>(below(5))));
      case 11:
        if (below(12) != 0) return write();
        return count(world_.add_body("{name: ball_" + std::to_string(below(4)) +
                                     ", mass: 0.5, pose: {xyz: [1, 1, 2]}, shapes: [{sphere: 0.05}]}"));
      case 12:
        if (below(12) != 0) return write();
        return count(world_.remove_body("ball_" + std::to_string(below(4))));
      case 13:
        if (below(12) != 0) return write();
        return spawn("robot_" + std::to_string(below(3)));
      case 14:
        if (below(12) != 0) return write();
        return count(world_.remove_model("robot_" + std::to_string(below(3))));
      default:
        return write();
    }
  }
  int spawned() const { return spawned_; }
  int done() const { return done_; }

 private:
  std::size_t below(std::size_t most) { return random_() % most; }
  std::int64_t later(std::size_t most) {
    return world_.tick_count() + 1 + static_cast<std::int64_t>(below(most));
  }
  double share() { return static_cast<double>(random_() % 1'000'000) * 1e-6; }
  Vector3d vector(double size) { return size * Vector3d(share() - 0.5, share() - 0.5, share() - 0.5); }
  world::BodyId body() { return {static_cast<std::int32_t>(below(world_.model().bodies.size()))}; }
  world::Pose pose() {
    return {vector(2.0) + Vector3d(0, 0, 1.5),
            Eigen::Quaterniond(0.5 + share(), share(), share(), share()).normalized()};
  }
  void count(const cycle::Outcome& outcome) { done_ += outcome.done(); }
  void set_joints() {
    if (world_.model().joints.empty()) return;
    const world::JointPlacement to{{static_cast<std::int32_t>(below(world_.model().joints.size()))},
                                   2.0 * share() - 1.0,
                                   below(2) == 0 ? 0.0 : share() - 0.5};
    count(world_.set_joints({&to, 1}));
  }
  void spawn(const std::string& name) {
    static const std::filesystem::path kModels(VISUM_SOURCE_DIR "/models");
    const auto* const file = below(2) == 0 ? "two_link/two_link.urdf" : "cart/cart.yaml";
    const auto before = done_;
    count(world_.spawn({kModels / file, name, pose()}));
    spawned_ += done_ - before;
  }
  // Also to parts of models that came.
  void write() {
    const auto part = below(world_.parts().size());
    const auto& ports = world_.parts()[part].part->description().controller_inputs;
    if (ports.empty() || ports[0].minimum > -0.5 || ports[0].maximum < 0.5) return;
    world_.write_inputs(part, 0, std::vector{share() - 0.5});
    ++done_;
  }

  cycle::Simulation& world_;
  std::mt19937 random_{42};
  std::vector<std::uint64_t> snapshots_;
  int done_ = 0, spawned_ = 0;
};

std::filesystem::path kinematic_scene(const test::TempFiles& files) {
  return files.write("s.yaml",
                     "visum: 1\ninclude: [" VISUM_SOURCE_DIR
                     "/models/scenes/two_link.yaml]\n"
                     "engine: impulse\n"
                     "bodies:\n"
                     "- {name: box, mass: 1, pose: {xyz: [0.5, 0.5, 0.5]}, shapes: [{box: [0.1, 0.1, "
                     "0.1]}]}\n"
                     "- {name: door, kinematic: true, pose: {xyz: [1, 0, 0.5]}, shapes: [{box: [0.05, "
                     "1, 1]}]}\n"
                     "- {name: leaf, kinematic: true, pose: {xyz: [1, 0.6, 0.5]}, shapes: [{box: "
                     "[0.05, 0.2, 1]}]}\n"
                     "joints: [{name: hinge, type: hinge, parent: door, child: leaf, axis: [0, 0, 1], "
                     "limits: [-2, 2]}]\n");
}

TEST(AChangingWorld, TenThousandRandomOperationsReplayToTheSameBits) {
  const test::TempFiles files;
  const auto file = files.folder() / "run.mcap";
  std::uint64_t hash = 0;
  std::int64_t ticks = 0;
  int done = 0, spawned = 0;
  {
    config::FilesNoted noted;
    auto scene = scene::load_scene(kinematic_scene(files));
    scene.clock = scene::ClockKind::kFree;
    cycle::Simulation world(std::move(scene));
    Recorder recorder(world, Origin{std::move(noted.files), {}}, file);
    Operator random(world);
    for (int i = 0; i < 10'000; ++i) {
      random.operate();
      if (world.frozen()) world.reset();
      if (i % 2 == 1) world.tick(), ++ticks;
    }
    hash = world.state_hash();
    done = random.done();
    spawned = random.spawned();
  }
  const auto result = replay(file);
  EXPECT_TRUE(result.equal) << result.difference.what << " at tick " << result.difference.tick;
  EXPECT_EQ(result.ticks, static_cast<std::uint64_t>(ticks));
  EXPECT_EQ(result.last_hash, hash);
  EXPECT_GT(done, 6000) << "most operations are carried out";
  EXPECT_GT(spawned, 15) << "models come and go";
}

scene::Scene two_link() {
  return scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
}

// A world that runs, and the files that a daemon would keep for its clients.
class AKeptWorld : public ::testing::Test {
 protected:
  // All files: parts read theirs when they are made.
  static Origin origin_of_two_link() {
    config::FilesNoted noted;
    const cycle::Simulation same(two_link());
    return {std::move(noted.files), {}};
  }

  RecordedWorld world;
  const test::TempFiles files;
  const Origin origin = origin_of_two_link();
  const Archive archive{files.folder() / "kept", origin};
};

TEST_F(AKeptWorld, ARecordingThatBeginsWhileItRunsReplaysFromThere) {
  world.run(100);
  ASSERT_TRUE(world->add_body(kBall).done());
  world.run(50);
  auto recorder = archive.record(*world, "monday");
  world.run(10);  // it is made ready while the world ticks on
  recorder->begin();
  recorder->write_first();
  world->write_inputs(0, 0, std::vector{0.4});
  ASSERT_TRUE(
      world->set_body(world->model().find_body("ball"), world::Pose{{0, 0, 3}}, {0, 0, 0}, {0, 0, 0}).done());
  world.run(200);
  recorder->end();
  recorder.reset();
  const auto hash = world->state_hash();
  const auto result = replay(archive.recording_file("monday"));
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_EQ(result.ticks, 200u);
  EXPECT_EQ(result.last_hash, hash);
  EXPECT_THROW(archive.record(*world, "monday"), std::runtime_error) << "it is there already";
}

TEST_F(AKeptWorld, ASnapshotOnDiskIsRestoredToTheBitAfterARestart) {
  world->write_inputs(0, 0, std::vector{0.4});
  world.run(150);
  ASSERT_TRUE(world->add_body(kBall).done());
  world.run(50);
  State state;
  world->keep(state);
  archive.save(*world, "gripped", state);
  const auto hash = world->state_hash();
  world.run(300);
  const auto later = world->state_hash();

  RecordedWorld other;  // the server was started anew, and has gone on a while
  other.run(77);
  const auto loaded = archive.load(*other, "gripped");
  ASSERT_EQ(other->restore_state(loaded).text(), "");
  EXPECT_EQ(other->state_hash(), hash);
  EXPECT_EQ(other->tick_count(), 200);
  EXPECT_EQ(other->era(), 2u);
  other.run(300);
  EXPECT_EQ(other->state_hash(), later);
  const auto result = replay(other.finish());
  EXPECT_TRUE(result.equal) << result.difference.what;
  EXPECT_EQ(result.last_hash, later) << "the recording holds the restore";
}

TEST_F(AKeptWorld, AModelThatComesIsInTheRecordingAndInASnapshotOnDisk) {
  const std::filesystem::path cart(VISUM_SOURCE_DIR "/models/cart/cart.yaml");
  world.run(20);
  auto recorder = archive.record(*world, "monday");
  recorder->begin();
  recorder->write_first();
  ASSERT_EQ(world->spawn({cart, "second", {{0, 3, 0}, Eigen::Quaterniond::Identity()}}).text(), "");
  world->write_inputs(world->parts().size() - 1, 0, std::vector{0.1});
  world.run(100);
  State state;
  world->keep(state);
  archive.save(*world, "both", state);
  const auto hash = world->state_hash();
  ASSERT_EQ(world->remove_model("second").text(), "");
  world.run(20);
  recorder->end();
  recorder.reset();
  const auto replayed = replay(archive.recording_file("monday"));
  EXPECT_TRUE(replayed.equal) << replayed.difference.what;
  EXPECT_EQ(replayed.ticks, 120u);
  RecordedWorld other;
  ASSERT_EQ(other->restore_state(archive.load(*other, "both")).text(), "");
  EXPECT_EQ(other->state_hash(), hash);
  const auto rewound = rewind(archive.recording_file("monday"), 0.05, {}, {});
  EXPECT_TRUE(rewound.world->model().find_body("second/chassis").valid());
  EXPECT_EQ(rewound.world->parts().back().part->description().name, "second");
}

TEST_F(AKeptWorld, ASnapshotOfAnotherWorldIsRefusedAndNothingChanges) {
  State state;
  world->keep(state);
  archive.save(*world, "here", state);
  const auto refusal = [&](const cycle::Simulation& of, const std::string& name) {
    try {
      archive.load(of, name);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(refusal(*world, "there"), HasSubstr("no snapshot 'there'"));
  auto scene = two_link();
  scene.seed = 99;
  EXPECT_THAT(refusal(cycle::Simulation(std::move(scene)), "here"), HasSubstr("another seed"));
  const auto before = world->state_hash();
  State damaged = state;
  damaged.state.resize(damaged.state.size() / 2);
  EXPECT_FALSE(world->restore_state(damaged).done());
  EXPECT_EQ(world->state_hash(), before);
}

}  // namespace
}  // namespace visum::recording
