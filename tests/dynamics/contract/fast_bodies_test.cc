// Bodies that move by more than their own thickness within a tick do not pass through others, with any
// engine.
#include <cmath>
#include <numbers>

#include "tests/dynamics/contract/scenes.h"

namespace visum::dynamics::testing {
namespace {

constexpr double kPlateM = 0.01;
constexpr double kBallRadiusM = 0.02;
constexpr double kBallSpeed = 130.0;  // m/s: 0.13 m in a tick

class FastBodies : public Contract {
 protected:
  // A ball of 4 cm that flies along x at a plate at x = 0, whose thickness is along x.
  ModelBuilder shot(double start_x, double angle = 0.0, double restitution = 0.0) const {
    auto b = builder();
    b.model.gravity.setZero();
    const world::SurfaceId surface = b.add_surface(0.3, restitution);
    b.add_fixed_box("plate", {kPlateM, 2, 2}, at(0, 0, 0, angle, {0, 0, 1}), surface);
    b.body(b.add_sphere("ball", kBallRadiusM, 0.26, at(start_x, 0, 0), surface)).v_WB = {kBallSpeed, 0, 0};
    return b;
  }
};
VISUM_INSTANTIATE_CONTRACT(FastBodies);

// Wherever within a tick's way the plate is.
TEST_P(FastBodies, ABallDoesNotPassThroughAThinPlate) {
  for (int i = 0; i < 26; ++i) {
    const double start = -1.0 - 0.005 * i;
    Lab lab(shot(start).model);
    lab.run_ticks(30);
    EXPECT_LT(lab.body("ball").p_WC.x(), 0.0) << "from " << start;
    EXPECT_LT(lab.body("ball").v_WC.norm(), 1.0) << "from " << start;
    EXPECT_NEAR(lab.body("ball").p_WC.x(), -kBallRadiusM - 0.5 * kPlateM, 1e-3) << "from " << start;
  }
}

TEST_P(FastBodies, WithoutContinuousCollisionItDoes) {
  auto b = shot(-1.0);
  b.model.continuous_collision = false;
  Lab lab(b.model);
  lab.run_ticks(30);
  EXPECT_GT(lab.body("ball").p_WC.x(), 1.0);
}

TEST_P(FastBodies, ABallBouncesOffWithItsRestitution) {
  for (const double restitution : {0.5, 1.0}) {
    Lab lab(shot(-1.0, 0.0, restitution).model);
    lab.run_ticks(30);
    EXPECT_NEAR(lab.body("ball").v_WC.x(), -restitution * kBallSpeed, 0.02 * kBallSpeed) << restitution;
  }
}

TEST_P(FastBodies, ABallIsTurnedAsideByASlantingPlate) {
  Lab lab(shot(-1.0, std::numbers::pi / 4, 0.0).model);
  lab.run_ticks(30);
  const auto& ball = lab.body("ball");
  // It stays on the side of the plate from which it came, and keeps the speed along the plate, less friction.
  const Eigen::Vector3d normal(std::cos(std::numbers::pi / 4), std::sin(std::numbers::pi / 4), 0.0);
  EXPECT_LT(ball.p_WC.dot(normal), 0.0);
  EXPECT_LT(std::abs(ball.v_WC.dot(normal)), 1.0);
  EXPECT_GT(ball.v_WC.norm(), 0.4 * kBallSpeed);
}

// A miss is a miss: as if the plate were not there, to the bit.
TEST_P(FastBodies, ABallThatFliesPastIsNotTouched) {
  const auto flight = [&](double plate_y) {
    auto b = builder();
    b.model.gravity.setZero();
    b.add_fixed_box("plate", {kPlateM, 1, 1}, at(0, plate_y, 0));
    b.body(b.add_sphere("ball", kBallRadiusM, 0.26, at(-1, 0, 0))).v_WB = {kBallSpeed, 0, 0};
    Lab lab(b.model);
    lab.run_ticks(30);
    return lab.body("ball").p_WC;
  };
  EXPECT_EQ(flight(0.5 + kBallRadiusM + 1e-3), flight(100.0));
}

TEST_P(FastBodies, TwoBallsThatMeetHeadOnDoNotSwapPlaces) {
  auto b = builder();
  b.model.gravity.setZero();
  b.body(b.add_sphere("left", kBallRadiusM, 0.26, at(-1, 0, 0))).v_WB = {kBallSpeed, 0, 0};
  b.body(b.add_sphere("right", kBallRadiusM, 0.26, at(1, 0, 0))).v_WB = {-kBallSpeed, 0, 0};
  Lab lab(b.model);
  lab.run_ticks(30);
  EXPECT_LT(lab.body("left").p_WC.x() + kBallRadiusM, lab.body("right").p_WC.x());
  EXPECT_LT(lab.kinetic_energy(), 0.05 * 0.26 * kBallSpeed * kBallSpeed);
}

TEST_P(FastBodies, AFastBodyPushesOneThatIsFree) {
  auto b = builder();
  b.model.gravity.setZero();
  b.add_box("card", {0.002, 0.2, 0.2}, 0.26, at(0, 0, 0));
  b.body(b.add_sphere("ball", kBallRadiusM, 0.26, at(-1, 0, 0))).v_WB = {kBallSpeed, 0, 0};
  Lab lab(b.model);
  lab.run_ticks(30);
  // A plastic hit at the centre: both go on together, with half of the speed.
  EXPECT_LT(lab.body("ball").p_WC.x(), lab.body("card").p_WC.x());
  EXPECT_NEAR(lab.body("card").v_WC.x(), 0.5 * kBallSpeed, 0.02 * kBallSpeed);
  EXPECT_NEAR(lab.body("ball").v_WC.x(), 0.5 * kBallSpeed, 0.02 * kBallSpeed);
}

// A plate of 5 mm that falls edge on and turns, on a table of 5 mm.
TEST_P(FastBodies, ATumblingPlateDoesNotPassThroughATable) {
  for (int i = 0; i < 8; ++i) {
    auto b = builder();
    b.add_fixed_box("table", {4, 4, 0.005}, at(0, 0, 0));
    auto& plate = b.body(b.add_box("plate", {0.3, 0.3, 0.005}, 1.0, at(0, 0, 1.0 + 0.003 * i)));
    plate.v_WB = {0, 0, -60.0};
    plate.w_WB = {30.0, 20.0, 0};
    Lab lab(b.model);
    lab.run_ticks(200);
    EXPECT_GT(lab.body("plate").p_WC.z(), -0.01) << i;
  }
}

TEST_P(FastBodies, ABallDoesNotPassThroughAMesh) {
  auto b = shot(-1.0);
  make_boxes_sheets(b.model);
  Lab lab(b.model);
  lab.run_ticks(30);
  EXPECT_LT(lab.body("ball").p_WC.x(), 0.0);
  EXPECT_LT(lab.body("ball").v_WC.norm(), 1.0);
}

// A ball that slides fast over the seams of a floor is not held up by them.
TEST_P(FastBodies, SeamsOfAFloorDoNotHoldUpWhatSlides) {
  auto b = builder();
  const world::SurfaceId ice = b.add_surface(0.0, 0.0);
  for (int i = 0; i < 40; ++i)
    b.add_fixed_box("tile_" + std::to_string(i), {0.25, 1, 0.05}, at(0.25 * i, 0, -0.025), ice);
  b.body(b.add_sphere("ball", 0.05, 1.0, at(0, 0, 0.05), ice)).v_WB = {60.0, 0, 0};
  Lab lab(b.model);
  lab.run_ticks(150);
  EXPECT_NEAR(lab.body("ball").p_WC.x(), 9.0, 0.01);
  EXPECT_NEAR(lab.body("ball").v_WC.x(), 60.0, 0.01);
}

}  // namespace
}  // namespace visum::dynamics::testing
