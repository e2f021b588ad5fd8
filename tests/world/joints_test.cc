#include <gtest/gtest.h>

#include <numbers>

#include "server/world/world_state.h"
#include "tests/world/model.h"

namespace visum::world::testing {
namespace {

constexpr double kPi = std::numbers::pi;

Pose pose_of(const WorldModel& model, const WorldState& state, std::int32_t body) {
  return link_pose(model.bodies[static_cast<std::size_t>(body)],
                   state.bodies[static_cast<std::size_t>(body)]);
}

// Turns link_1 about its hinge (axis z, through its own frame) to an angle.
void turn(WorldState& state, double angle) {
  state.bodies[1].q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
}

TEST(InitialState, PlacesBodiesAtTheirCentreOfMass) {
  WorldModel model = good_model();
  model.bodies[3].p_BC = {0, 0.5, 0};
  model.bodies[3].X_WB.q = Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitZ());
  model.bodies[3].w_WB = {0, 0, 2};
  const WorldState state = initial_state(model);
  EXPECT_LT((state.bodies[3].p_WC - Eigen::Vector3d(8.5, 0, 0)).norm(), 1e-12);
  EXPECT_LT((state.bodies[3].v_WC - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
  EXPECT_LT((link_velocity(model.bodies[3], state.bodies[3])).norm(), 1e-12);
  EXPECT_LT((pose_of(model, state, 3).p - model.bodies[3].X_WB.p).norm(), 1e-12);
}

TEST(InitialState, AHingesPositionTurnsTheWholeSubtree) {
  WorldModel model = good_model();
  model.joints[0].initial_position = kPi / 2;
  const WorldState state = initial_state(model);
  EXPECT_LT((pose_of(model, state, 1).p - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((pose_of(model, state, 2).p - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
  EXPECT_NEAR(state.joints[0].position, kPi / 2, 1e-12);
  EXPECT_NEAR(state.joints[1].position, 0.0, 1e-12);
  EXPECT_EQ(pose_of(model, state, 3).p, model.bodies[3].X_WB.p) << "others stand where they stood";
}

TEST(InitialState, PositionsAddUpDownTheTree) {
  WorldModel model = good_model();
  model.joints[0].initial_position = -kPi / 2;
  model.joints[1].initial_position = 0.25;  // along z
  const WorldState state = initial_state(model);
  EXPECT_LT((pose_of(model, state, 2).p - Eigen::Vector3d(1, -1, 0.25)).norm(), 1e-12);
  EXPECT_NEAR(state.joints[1].position, 0.25, 1e-12);
}

TEST(InitialState, MoreThanOneTurnIsKept) {
  WorldModel model = good_model();
  model.joints[0].initial_position = 5.0 * kPi;
  EXPECT_NEAR(initial_state(model).joints[0].position, 5.0 * kPi, 1e-12);
}

TEST(InitialState, QuaternionsAreOfUnitLength) {
  WorldModel model = good_model();
  model.bodies[3].X_WB.q.coeffs() *= 1.0 + 5e-7;  // find_fault lets it pass
  EXPECT_NEAR(initial_state(model).bodies[3].q_WB.norm(), 1.0, 1e-15);
}

TEST(MeasureJoints, AHingesAngleGoesOnAcrossTurnsInBothDirections) {
  const WorldModel model = good_model();
  WorldState state = initial_state(model);
  for (int i = 1; i <= 500; ++i) {
    turn(state, 0.1 * i);
    measure_joints(model, state);
    ASSERT_NEAR(state.joints[0].position, 0.1 * i, 1e-9);
  }
  for (int i = 499; i >= -500; --i) {
    turn(state, 0.1 * i);
    measure_joints(model, state);
    ASSERT_NEAR(state.joints[0].position, 0.1 * i, 1e-9);
  }
}

TEST(MeasureJoints, AQuaternionAndItsNegativeAreTheSameAngle) {
  const WorldModel model = good_model();
  WorldState state = initial_state(model);
  turn(state, 2.0);
  state.bodies[1].q_WB.coeffs() *= -1.0;
  measure_joints(model, state);
  EXPECT_NEAR(state.joints[0].position, 2.0, 1e-12);
}

TEST(MeasureJoints, VelocitiesAreRelativeToTheParent) {
  const WorldModel model = good_model();
  WorldState state = initial_state(model);
  // The whole arm turns about z through the hinge with 3 rad/s; the slider's carriage moves up with 0.5 m/s.
  state.bodies[1].w_WB = state.bodies[2].w_WB = {0, 0, 3};
  state.bodies[2].v_WC =
      Eigen::Vector3d(0, 0, 3).cross(Eigen::Vector3d(1, 0, 0)) + Eigen::Vector3d(0, 0, 0.5);
  measure_joints(model, state);
  EXPECT_NEAR(state.joints[0].velocity, 3.0, 1e-12);
  EXPECT_NEAR(state.joints[1].velocity, 0.5, 1e-12);
}

TEST(MeasureJoints, ASlidersVelocityIsTheRateOfItsPositionWhileItsParentTumbles) {
  WorldModel model = good_model();
  model.joints.erase(model.joints.begin());
  model.bodies[2].p_BC = {0.1, -0.2, 0.3};
  WorldState state = initial_state(model);
  const Eigen::Vector3d w(0.3, -0.7, 0.2), v(1, 2, 3);
  const double rate = 0.4;
  const auto move = [&](double t) {
    const Pose X_WP{Eigen::Vector3d(1, 0, 0) + v * t,
                    Eigen::Quaterniond(Eigen::AngleAxisd(w.norm() * t, w.normalized()))};
    const Pose X_WC = X_WP * Pose{{1, 0, 0.1 + rate * t}, Eigen::Quaterniond::Identity()};
    state.bodies[1] = {X_WP.p, X_WP.q, v, w};
    const Eigen::Vector3d p_PC = X_WC * model.bodies[2].p_BC - X_WP.p;
    state.bodies[2] = {X_WP.p + p_PC, X_WC.q, v + w.cross(p_PC) + X_WP.q * Eigen::Vector3d(0, 0, rate), w};
    measure_joints(model, state);
    return state.joints[0];
  };
  EXPECT_NEAR(move(1.3).position, 0.1 + rate * 1.3, 1e-12);
  EXPECT_NEAR(move(1.3).velocity, rate, 1e-12);
}

TEST(MeasureJoints, AScrewIsCarriedAlongItsAxisByItsInitialAngle) {
  WorldModel model = good_model();
  model.joints[1].kind = JointKind::kScrew;
  model.joints[1].pitch_m = 0.01;
  model.joints[1].initial_position = 7.0 * kPi;
  const WorldState state = initial_state(model);
  EXPECT_LT((pose_of(model, state, 2).p - Eigen::Vector3d(2, 0, 0.035)).norm(), 1e-12);
  EXPECT_NEAR(state.joints[1].position, 7.0 * kPi, 1e-9);
}

TEST(MeasureJoints, ASpringMeasuresItsLengthAndHowFastItGrows) {
  WorldModel model = good_model();
  model.joints[1].kind = JointKind::kSpring;
  model.joints[1].X_CJ.p = {0, 0, 2};  // from (1, 0, 0) of link_1, at x = 1, to (0, 0, 2) of link_2, at x = 2
  WorldState state = initial_state(model);
  EXPECT_NEAR(state.joints[1].position, 2.0, 1e-15);
  state.bodies[2].v_WC = {5, 0, 3};
  measure_joints(model, state);
  EXPECT_NEAR(state.joints[1].velocity, 3.0, 1e-15);
}

TEST(MeasureJoints, AJointWithoutACoordinateMeasuresNothing) {
  for (const JointKind kind : {JointKind::kBall, JointKind::kUniversal, JointKind::kCylindrical}) {
    WorldModel model = good_model();
    model.joints[0].kind = kind;
    WorldState state = initial_state(model);
    turn(state, 1.0);
    measure_joints(model, state);
    EXPECT_EQ(state.joints[0].position, 0.0);
  }
}

TEST(MeasureJoints, APointOnACurveIsFollowedRoundAndRound) {
  WorldModel model = good_model();
  Joint& joint = model.joints[1];
  joint.kind = JointKind::kPointOnCurve;
  joint.curve_J = Curve({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, true);
  WorldState state = initial_state(model);
  const Eigen::Vector3d start = state.bodies[2].p_WC;
  for (int i = 1; i <= 250; ++i) {
    const Curve::Place place = joint.curve_J.at(0.04 * i);
    state.bodies[2].p_WC = start + place.p;
    state.bodies[2].v_WC = 3.0 * place.tangent;
    measure_joints(model, state);
    ASSERT_NEAR(state.joints[1].position, 0.04 * i, 1e-9);
    ASSERT_NEAR(state.joints[1].velocity, 3.0, 1e-9);
  }
}

TEST(Curve, PassesThroughItsPointsWithContinuousCurvature) {
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 1, 1}};
  for (const bool closed : {false, true}) {
    const Curve curve(points, closed);
    double u = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LT((curve.at(u).p - points[i]).norm(), 1e-12);
      const Curve::Place before = curve.at(u - 1e-9), after = curve.at(u + 1e-9);
      EXPECT_LT((after.tangent - before.tangent).norm(), 1e-7);
      EXPECT_LT((after.bend - before.bend).norm(), 1e-6);
      if (i + 1 < points.size()) u += (points[i + 1] - points[i]).norm();
    }
  }
}

TEST(Curve, ItsDerivativesAreThoseOfItsPlaces) {
  const Curve curve({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 1, 1}}, true);
  for (const double u : {0.3, 1.7, 4.0, 5.5, -0.4, 9.0}) {
    const double e = 1e-5;
    const Curve::Place before = curve.at(u - e), here = curve.at(u), after = curve.at(u + e);
    EXPECT_LT(((after.p - before.p) / (2.0 * e) - here.tangent).norm(), 1e-8);
    EXPECT_LT(((after.tangent - before.tangent) / (2.0 * e) - here.bend).norm(), 1e-6);
  }
}

TEST(Curve, ThatIsNoneIsEmpty) {
  EXPECT_TRUE(Curve({{0, 0, 0}}, false).empty());
  EXPECT_TRUE(Curve({{0, 0, 0}, {0, 0, 0}}, false).empty());
  EXPECT_TRUE(Curve({{0, 0, 0}, {1, 0, 0}}, true).empty());
  EXPECT_TRUE(Curve({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, true).empty());
}

TEST(MeasureJoints, AFixedJointMeasuresNothing) {
  WorldModel model = good_model();
  model.joints[0].kind = JointKind::kFixed;
  WorldState state = initial_state(model);
  turn(state, 1.0);
  measure_joints(model, state);
  EXPECT_EQ(state.joints[0].position, 0.0);
}

}  // namespace
}  // namespace visum::world::testing
