// A daemon that shows a recording: clients see it and move in it, but cannot change it.
#include "server/gateway/playback.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>

#include "server/recording/recorder.h"
#include "server/world/world_state.h"
#include "tests/gateway/running_daemon.h"
#include "tests/support/temp_files.h"

namespace visum::gateway {
namespace {

using protocol::ErrorCode;

class PlaybackTest : public testing::Test {
 protected:
  // Called before each tick of the recorded world, with the number of ticks so far.
  using Acts = void (*)(cycle::Simulation& world, int ticks);
  static void reset_late(cycle::Simulation& world, int ticks) {
    if (ticks == 1200) world.reset();
  }

  // `of_b`: acts of a second recording, of so many ticks, that is shown beside the first; null: there is
  // none.
  explicit PlaybackTest(Acts acts = reset_late, Acts of_b = nullptr, int ticks_of_b = 0) {
    record(file(), acts, kTicks, {hashes_, angles_, poses_});
    if (of_b) record(second_file(), of_b, ticks_of_b, {hashes_of_b_, angles_of_b_, poses_of_b_});
    playback_ = std::make_unique<Playback>(file(), recording::PluginFolders{},
                                           of_b ? second_file() : std::filesystem::path{});
    DaemonOptions options;
    options.port = 0;
    options.playback = playback_.get();
    daemon_ = std::make_unique<Daemon>(playback_->world(), options);
    thread_ = std::thread([this] { daemon_->run(); });
    client_.emplace("127.0.0.1", daemon_->port(),
                    protocol::Hello{1, 1, "viewer", protocol::Role::kAdmin, {}});
  }
  ~PlaybackTest() override {
    daemon_->stop();
    thread_.join();
  }

  static constexpr int kTicks = 1500;
  std::filesystem::path file() const { return files_.folder() / "run.mcap"; }
  std::filesystem::path second_file() const { return files_.folder() / "other.mcap"; }
  protocol::Connection& client() { return *client_; }
  const Playback& playback() const { return *playback_; }
  void seek(std::int64_t position) {
    client().request_as<protocol::Ok>(protocol::SetParameter{"recording", "Position", position});
  }
  protocol::ServerStatus status() { return client().request_as<protocol::ServerStatus>(protocol::Status{}); }
  std::string report() {
    const auto board =
        client().request_as<protocol::BlackboardData>(protocol::ReadBlackboard{"recording", "Report", 0, 0});
    return {reinterpret_cast<const char*>(board.data.data()), board.data.size()};
  }
  // Asks until the status is as it should be. Time is the recording's, so this comes or hangs.
  template <typename Condition>
  protocol::ServerStatus status_once(const Condition& condition) {
    auto now = status();
    while (!condition(now)) now = status();
    return now;
  }

  // By position.
  using Hashes = std::vector<std::uint64_t>;
  using Numbers = std::vector<std::vector<double>>;
  Hashes hashes_, hashes_of_b_;
  Numbers angles_, angles_of_b_;
  Numbers poses_, poses_of_b_;  // 7 numbers for each body
  std::unique_ptr<Playback> playback_;

 private:
  struct Notes {
    Hashes& hashes;
    Numbers& angles;
    Numbers& poses;
  };

  void record(const std::filesystem::path& to, Acts acts, int ticks, Notes notes) {
    config::FilesNoted noted;
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
    cycle::Simulation world(std::move(scene));
    recording::Recorder recorder(world, {std::move(noted.files), ""}, to);
    note(world, notes);
    world.write_inputs(0, 0, std::vector{0.7, -0.3});
    for (int i = 0; i < ticks; ++i) {
      acts(world, i);
      world.tick();
      note(world, notes);
    }
  }
  static void note(const cycle::Simulation& world, Notes notes) {
    notes.hashes.push_back(world.state_hash());
    notes.angles.push_back(world.parts()[0].sensor_outputs);
    auto& poses = notes.poses.emplace_back();
    for (std::size_t i = 0; i < world.model().bodies.size(); ++i) {
      const auto X_WB = world::link_pose(world.model().bodies[i], world.state().bodies[i]);
      poses.insert(poses.end(),
                   {X_WB.p.x(), X_WB.p.y(), X_WB.p.z(), X_WB.q.w(), X_WB.q.x(), X_WB.q.y(), X_WB.q.z()});
    }
  }

  test::TempFiles files_;
  std::unique_ptr<Daemon> daemon_;
  std::thread thread_;
  std::optional<protocol::Connection> client_;
};

class PlaybackOfAModelThatComesAndGoes : public PlaybackTest {
 protected:
  static void come_and_go(cycle::Simulation& world, int ticks) {
    static const std::filesystem::path kCart(VISUM_SOURCE_DIR "/models/cart/cart.yaml");
    cycle::Outcome outcome;
    if (ticks == 500) outcome = world.spawn({kCart, "second", {{0, 3, 0}, Eigen::Quaterniond::Identity()}});
    if (ticks == 900) outcome = world.remove_model("second");
    EXPECT_EQ(outcome.text(), "");
  }
  PlaybackOfAModelThatComesAndGoes() : PlaybackTest(come_and_go) {}
};

TEST_F(PlaybackOfAModelThatComesAndGoes, ShowsItsPartsWhereTheyWere) {
  for (const std::int64_t position : {700, 100, 899, 1300, 600, 1450, 20}) {
    SCOPED_TRACE(position);
    seek(position);
    EXPECT_EQ(status().state_hash, hashes_[static_cast<std::size_t>(position)]);
    const bool is_there = position > 500 && position < 900;
    std::vector<std::string> names;
    for (const auto& part : client().request_as<protocol::PartList>(protocol::ListParts{}).parts)
      names.push_back(part.name);
    EXPECT_EQ(std::ranges::count(names, "second"), is_there ? 1 : 0);
    EXPECT_EQ(std::ranges::count(names, "robot"), 1);
    if (is_there) {
      const auto sample = client().request_as<protocol::PartSample>(protocol::Read{"second"});
      EXPECT_FALSE(sample.sensor_outputs.empty());
    }
  }
}

class PlaybackOfScenes : public PlaybackTest {
 protected:
  static void load(cycle::Simulation& world, int ticks) {
    if (ticks != 400 && ticks != 900) return;
    const char* const scene = ticks == 400 ? "two_robots.yaml" : "cart.yaml";
    auto change =
        world.begin_load({std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes" / scene, {}, {}, {}});
    ASSERT_EQ(cycle::prepare(change).text(), "");
    ASSERT_EQ(world.load_scene(change).text(), "");
  }
  PlaybackOfScenes() : PlaybackTest(load) {}
};

TEST_F(PlaybackOfScenes, ShowsEachSceneWhereItWas) {
  for (const std::int64_t position : {700, 100, 1300, 600, 20, 1450, 401, 400}) {
    SCOPED_TRACE(position);
    seek(position);
    EXPECT_EQ(status().state_hash, hashes_[static_cast<std::size_t>(position)]);
    const auto* const scene = position <= 400 ? "two_link" : position <= 900 ? "two_robots" : "cart";
    EXPECT_EQ(client().request_as<protocol::WorldDescription>(protocol::DescribeWorld{}).scene, scene);
    const auto parts = client().request_as<protocol::PartList>(protocol::ListParts{}).parts;
    EXPECT_EQ(parts.size(), position > 400 && position <= 900 ? 3u : 2u) << "with the part that steers";
    for (const auto& part : parts) client().request_as<protocol::PartSample>(protocol::Read{part.name});
  }
}

TEST_F(PlaybackTest, StandsAtItsBeginningUntilItIsPlayed) {
  const auto now = status();
  EXPECT_TRUE(now.paused);
  EXPECT_EQ(now.tick, 0);
  EXPECT_EQ(now.state_hash, hashes_[0]);
}

TEST_F(PlaybackTest, TellsWhatHappenedAsJson) {
  EXPECT_EQ(playback().events(),
            R"({"left_out":0,"events":[{"position":1200,"era":1,"tick":1200,"time_ns":1200000000,)"
            R"("level":"info","kind":"reset","part":"","text":"back to the beginning: time and state"}]})");
}

TEST_F(PlaybackTest, JumpsToAnyTickAndShowsItsPorts) {
  auto era = status().era;
  for (const std::int64_t position : {700, 1100, 20, 1500, 1199}) {
    SCOPED_TRACE(position);
    seek(position);
    const auto now = status();
    const auto at = static_cast<std::size_t>(position);
    EXPECT_EQ(now.tick, position > 1200 ? position - 1200 : position);
    EXPECT_EQ(now.state_hash, hashes_[at]);
    EXPECT_GT(now.era, era) << "for a client, the clock goes back only in a new era";
    era = now.era;
    const auto sample = client().request_as<protocol::PartSample>(protocol::Read{"robot"});
    EXPECT_EQ(sample.sensor_outputs, angles_[at]);
    const auto steering = client().request_as<protocol::PartSample>(protocol::Read{"recording"});
    EXPECT_EQ(steering.sensor_outputs, std::vector{static_cast<double>(position)});
  }
}

TEST_F(PlaybackTest, PlaysAtAnySpeedAndStandsAtItsEnd) {
  client().request_as<protocol::Ok>(protocol::SetSpeed{100.0});
  client().request_as<protocol::Ok>(protocol::Resume{});
  const auto end = status_once([](const auto& now) { return now.paused && now.tick == 300; });
  EXPECT_EQ(end.state_hash, hashes_[1500]);
  seek(10);
  EXPECT_EQ(status().tick, 10);
  client().request_as<protocol::Advanced>(protocol::Step{5});
  EXPECT_EQ(status().state_hash, hashes_[15]);
}

TEST_F(PlaybackTest, AStepIsAnsweredWithTheEraThatIsShown) {
  seek(700);
  seek(20);
  const auto advanced = client().request_as<protocol::Advanced>(protocol::Step{5});
  EXPECT_EQ(advanced.tick, 25);
  EXPECT_EQ(advanced.era, status().era);
  seek(1198);
  const auto beyond_the_reset = client().request_as<protocol::Advanced>(protocol::Step{5});
  EXPECT_EQ(beyond_the_reset.tick, 3);
  EXPECT_EQ(beyond_the_reset.era, status().era);
}

TEST_F(PlaybackTest, ComparesAllOfItWhileItStands) {
  auto found = report();
  while (found.find("\"compared\":1500") == std::string::npos) found = report();
  EXPECT_NE(found.find("\"equal\":true"), std::string::npos) << found;
  EXPECT_NE(found.find("\"ticks\":1500"), std::string::npos) << found;
}

// A second recording beside the first: it is pushed to another angle at tick 800, and ends at tick 1000.
class PlaybackOfTwo : public PlaybackTest {
 protected:
  static constexpr int kParts = 800, kEndOfB = 1000;
  static void push_aside(cycle::Simulation& world, int ticks) {
    if (ticks == kParts) world.write_inputs(0, 0, std::vector{-0.4, -0.3});
  }
  PlaybackOfTwo() : PlaybackTest([](cycle::Simulation&, int) {}, push_aside, kEndOfB) {}

  std::vector<double> bodies_of_b() {
    const auto board =
        client().request_as<protocol::BlackboardData>(protocol::ReadBlackboard{"recording", "Beside", 0, 0});
    std::vector<double> numbers(board.data.size() / sizeof(double));
    std::memcpy(numbers.data(), board.data.data(), board.data.size());
    return numbers;
  }
  static constexpr std::size_t kHead = 2, kNumbers = 9;
};

TEST_F(PlaybackOfTwo, TellsWhereTheyPartAsVisumCompareDoes) {
  auto found = report();
  while (found.find("\"over\":true") == std::string::npos) found = report();
  EXPECT_NE(found.find("\"first\":{\"position\":801,\"tick\":801}"), std::string::npos) << found;
  EXPECT_NE(found.find("\"beside\":{\"file\":\"other.mcap\",\"ticks\":1000,\"compared\":1500"),
            std::string::npos)
      << found;
  EXPECT_NE(found.find("{\"part\":\"robot\",\"port\":\"Desired Angle 1\",\"position\":801,\"tick\":801,"
                       "\"a\":\"0.7\",\"b\":\"-0.4\","),
            std::string::npos)
      << found;
}

TEST_F(PlaybackOfTwo, ShowsTheBodiesOfTheSecondAtTheSameTick) {
  const auto bodies = poses_[0].size() / 7;
  for (const std::int64_t position : {900, 100, 800, 1400, 950}) {
    SCOPED_TRACE(position);
    seek(position);
    const auto numbers = bodies_of_b();
    ASSERT_EQ(numbers.size(), kHead + kNumbers * bodies);
    EXPECT_EQ(numbers[0], static_cast<double>(position));
    EXPECT_EQ(numbers[1], static_cast<double>(position) / 1000.0);
    const auto& b = poses_of_b_[static_cast<std::size_t>(std::min<std::int64_t>(position, kEndOfB))];
    const auto& a = poses_[static_cast<std::size_t>(position)];
    for (std::size_t body = 0; body < bodies; ++body) {
      SCOPED_TRACE(body);
      const auto* shown = &numbers[kHead + kNumbers * body];
      EXPECT_TRUE(std::equal(shown, shown + 7, &b[7 * body]));
      const double metres = std::hypot(a[7 * body] - b[7 * body], a[7 * body + 1] - b[7 * body + 1],
                                       a[7 * body + 2] - b[7 * body + 2]);
      EXPECT_NEAR(shown[7], metres, 1e-12);
      const bool same = std::equal(&a[7 * body], &a[7 * body + 7], &b[7 * body]);
      EXPECT_EQ(same, shown[7] == 0.0 && shown[8] == 0.0);
    }
  }
}

TEST_F(PlaybackOfTwo, GivesThePortsOfTheSecondAtTheTimesOfTheFirst) {
  const auto text = playback_->ports_at("/recording/beside/ports/0/1100/400").value();
  std::vector<double> rows(text.size() / sizeof(double));
  std::memcpy(rows.data(), text.data(), text.size());
  const auto outputs = angles_of_b_[0].size();
  const auto inputs =
      client().request_as<protocol::PartSample>(protocol::Read{"robot"}).controller_inputs.size();
  const auto width = 1 + inputs + outputs;
  ASSERT_EQ(rows.size(), 300 * width) << "of 701 to 1100, B has 701 to 1000";
  for (const std::size_t row : {0u, 150u, 299u}) {
    EXPECT_EQ(rows[row * width], static_cast<double>(701 + row) / 1000.0);
    EXPECT_TRUE(std::equal(angles_of_b_[701 + row].begin(), angles_of_b_[701 + row].end(),
                           &rows[row * width + 1 + inputs]));
  }
  EXPECT_EQ(playback_->ports_at("/recording/beside/ports/0/1500/100").value(), "") << "B has ended";
  EXPECT_FALSE(playback_->ports_at("/recording/beside/ports/7/1100/400"));
}

TEST_F(PlaybackTest, HasNothingBesideItUnlessAsked) {
  EXPECT_FALSE(playback_->ports_at("/recording/beside/ports/0/1100/400"));
  EXPECT_EQ(report().find("beside"), std::string::npos);
}

TEST_F(PlaybackTest, NothingInItCanBeChanged) {
  const std::vector<protocol::Request> changes{protocol::AcquireLease{"robot", 0, false},
                                               protocol::Write{"robot", 0, {0.1}, 0},
                                               protocol::SetParameter{"robot", "Emergency Stop", true},
                                               protocol::Reset{},
                                               protocol::TakeSnapshot{},
                                               protocol::RestoreSnapshot{1},
                                               protocol::SetBody{"robot/fore"},
                                               protocol::SetJoints{"robot", {{"elbow", 0.1}}},
                                               protocol::PullBody{"robot/fore", {}, {0, 0, 1}, 1.0},
                                               protocol::ReleaseBody{"robot/fore"},
                                               protocol::PushBody{"robot/fore", {1, 0, 0}, {}, {}, 1'000'000},
                                               protocol::AddBody{"{name: a, mass: 1}"},
                                               protocol::RemoveBody{"floor"},
                                               protocol::InjectFault{"robot", "part_silent", {}, 0},
                                               protocol::Join{},
                                               protocol::Advance{1}};
  seek(500);
  for (const auto& change : changes) {
    const auto refusal = refusal_of([&] { client().request(change); });
    EXPECT_EQ(refusal.code(), ErrorCode::kWrongState);
    EXPECT_NE(std::string(refusal.what()).find("this is a recording"), std::string::npos) << refusal.what();
  }
  EXPECT_EQ(status().state_hash, hashes_[500]);
}

TEST_F(PlaybackTest, APositionThatIsNotInItIsRefused) {
  for (const std::int64_t position : {std::int64_t{-1}, std::int64_t{1501}, INT64_MAX})
    EXPECT_EQ(refusal_of([&] { seek(position); }).code(), ErrorCode::kBadValue);
  const protocol::SetParameter text{"recording", "Position", std::string("5")};
  EXPECT_EQ(refusal_of([&] { client().request(text); }).code(), ErrorCode::kBadValue);
}

}  // namespace
}  // namespace visum::gateway
