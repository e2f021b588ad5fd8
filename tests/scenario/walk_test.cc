// The quadruped's walking controller: the geometry of its legs, what it knows of its own motion, and whole
// walks in a world without a network.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "clients/examples/quadruped/walker.h"
#include "server/cycle/simulation.h"

namespace visum::quadruped {
namespace {

constexpr int kJoints = 3 * kLegs;

TEST(QuadrupedLeg, StandsUnderItsHipAsTheSceneBendsIt) {
  // 2 * 0.2 m * cos(0.7) below the hip, as models/scenes/quadruped.yaml says.
  EXPECT_LT((foot(kLeg[0], {0, 0.7, -1.4}) - Vector3d(0.18, 0.12, -0.4 * std::cos(0.7))).norm(), 1e-12);
}

TEST(QuadrupedLeg, FindsTheAnglesThatBringItsFootToAPlace) {
  for (const Leg& leg : kLeg) {
    for (const Vector3d& angles :
         {Vector3d(0, 0.7, -1.4), Vector3d(0.4, 0.2, -0.5), Vector3d(-0.4, 1.2, -2.0)})
      EXPECT_LT((angles_for(leg, foot(leg, angles)) - angles).norm(), 1e-9) << angles.transpose();
  }
}

TEST(QuadrupedLeg, APlaceOutOfReachGivesAnglesOfThatDirection) {
  const Vector3d far = kLeg[0].hip + Vector3d(0.3, 0.05, -0.4),
                 reached = foot(kLeg[0], angles_for(kLeg[0], far));
  EXPECT_TRUE(reached.allFinite());
  EXPECT_NEAR(reached.z() / reached.x(), far.z() / (far.x()), 0.5);
  EXPECT_LT(angles_for(kLeg[0], far)[2], -0.3) << "within the knee's limits";
  EXPECT_TRUE(angles_for(kLeg[0], kLeg[0].hip).allFinite()) << "the hip itself";
}

TEST(QuadrupedLeg, ItsJacobianIsTheDerivativeOfItsFoot) {
  constexpr double kStep = 1e-6;
  const Vector3d angles(0.3, 0.8, -1.5);
  for (const Leg& leg : kLeg) {
    for (int i = 0; i < 3; ++i) {
      const Vector3d d = kStep * Vector3d::Unit(i);
      const Vector3d difference = (foot(leg, angles + d) - foot(leg, angles - d)) / (2.0 * kStep);
      EXPECT_LT((jacobian(leg, angles).col(i) - difference).norm(), 1e-8) << i;
    }
  }
}

TEST(QuadrupedMotion, TheVerticalFollowsATrunkThatTurns) {
  Motion motion;
  Readings readings;
  for (auto& angles : readings.angles) angles = {0, 0.7, -1.4};
  for (auto& speeds : readings.speeds) speeds.setZero();
  readings.rate = {0, 0.5, 0};  // for 0.2 s: the nose goes down by 0.1 rad
  for (int i = 0; i < 200; ++i) motion.update(readings, {true, true, true, true}, false);
  EXPECT_NEAR(motion.up().x(), -std::sin(0.1), 1e-3);
  readings.rate = {0, 0, 0.5};
  for (int i = 0; i < 200; ++i) motion.update(readings, {true, true, true, true}, false);
  EXPECT_NEAR(motion.heading(), 0.1, 1e-3);
}

// The scene with the controller in front of its ports, tick by tick.
class Walk {
 public:
  explicit Walk(const Course& course, const char* engine = "impulse")
      : world_(scene(engine)), walker_(course) {
    for (std::size_t i = 0; i < world_.parts().size(); ++i) {
      if (world_.parts()[i].part->description().name == "legs") legs_ = i;
      if (world_.parts()[i].part->description().name == "imu") imu_ = i;
    }
    trunk_ = world_.model().find_body("dog/trunk");
  }

  void cycle() {
    const Commands commands = walker_.cycle(readings());
    std::vector<double> inputs;
    for (const auto* values : {&commands.angles, &commands.speeds, &commands.efforts})
      for (const Vector3d& leg : *values) inputs.insert(inputs.end(), leg.data(), leg.data() + 3);
    world_.write_inputs(legs_, 0, inputs);
    world_.tick();
  }

  Readings readings() const {
    const auto& legs = world_.parts()[legs_].sensor_outputs;
    const auto& imu = world_.parts()[imu_].sensor_outputs;
    Readings now;
    for (int i = 0; i < kJoints; ++i) {
      now.angles[i / 3][i % 3] = legs[i];
      now.speeds[i / 3][i % 3] = legs[kJoints + i];
    }
    now.rate = {imu[0], imu[1], imu[2]};
    now.acceleration = {imu[3], imu[4], imu[5]};
    return now;
  }

  // Walks to the end, or until it has fallen; at most 20 s.
  bool arrives() {
    for (int i = 0; i < 20000 && !walker_.done(); ++i) {
      cycle();
      if (up() < 0.5) return false;
    }
    return walker_.done();
  }

  void push(const Vector3d& force, double seconds) {
    const auto until = world_.tick_count() + static_cast<std::int64_t>(1e3 * seconds);
    ASSERT_TRUE(world_.push({{trunk_, force, Vector3d::Zero()}, until}).done());
  }

  double up() const { return (trunk().q_WB * Vector3d::UnitZ()).z(); }
  const world::BodyState& trunk() const { return world_.state().bodies[trunk_.index()]; }
  const Walker& walker() const { return walker_; }
  std::uint64_t state_hash() const { return world_.state_hash(); }

 private:
  static scene::Scene scene(const std::string& engine) {
    scene::Options options;
    options.parameters = "{engine: " + engine + "}";
    return scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/quadruped.yaml",
                             options);
  }

  cycle::Simulation world_;
  Walker walker_;
  std::size_t legs_ = 0, imu_ = 0;
  world::BodyId trunk_;
};

TEST(QuadrupedWalk, KnowsHowFarItHasWalkedByItsLegsAndImu) {
  for (const char* engine : {"impulse", "ode"}) {
    Walk walk({.distance = 1.0, .speed = 0.4}, engine);
    ASSERT_TRUE(walk.arrives()) << engine;
    EXPECT_NEAR(walk.trunk().p_WC.x(), 1.0, 0.1) << engine;
    EXPECT_NEAR(walk.walker().motion().way(), walk.trunk().p_WC.x(), 0.05) << engine;
    EXPECT_NEAR(walk.trunk().p_WC.y(), 0.0, 0.05) << engine;
  }
}

TEST(QuadrupedWalk, GoesOnAfterAPushFromTheSide) {
  Walk walk({.distance = 1.2, .speed = 0.4});
  for (int i = 0; i < 2000; ++i) walk.cycle();
  walk.push({0, 60, 0}, 0.1);  // 0.5 m/s for 12 kg
  double fastest = 0.0;
  for (int i = 0; i < 300; ++i) {
    walk.cycle();
    fastest = std::max(fastest, walk.trunk().v_WC.y());
  }
  EXPECT_GT(fastest, 0.2) << "the push was felt";
  ASSERT_TRUE(walk.arrives());
  EXPECT_GT(walk.up(), 0.99);
  EXPECT_NEAR(walk.trunk().p_WC.x(), 1.2, 0.15);
}

TEST(QuadrupedWalk, FallsUnderAPushThatNothingCouldStand) {
  Walk walk({.distance = 1.2, .speed = 0.4});
  for (int i = 0; i < 1000; ++i) walk.cycle();
  walk.push({0, 600, 0}, 0.2);
  EXPECT_FALSE(walk.arrives());
}

TEST(QuadrupedWalk, IsTheSameTwice) {
  Walk a({.distance = 0.3, .speed = 0.4}), b({.distance = 0.3, .speed = 0.4});
  for (int i = 0; i < 1500; ++i) {
    a.cycle();
    b.cycle();
  }
  EXPECT_EQ(a.state_hash(), b.state_hash());
}

}  // namespace
}  // namespace visum::quadruped
