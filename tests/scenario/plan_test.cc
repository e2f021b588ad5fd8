// The example controller's plans, without a server: what it can do, what it refuses, and that its ways join.
#include "clients/examples/pick_and_place/plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "clients/examples/pick_and_place/kinematics.h"

namespace visum::pick_and_place {
namespace {

class Plans : public testing::Test {
 protected:
  Plans() : start_(7) { start_ << 0, -0.4, 0, 1.6, 0, 1.418, 0; }

  static Job job(double from_x, double from_y, double to_x, double to_y) {
    Job job;
    job.from = {from_x, from_y, 0.2};
    job.to = {to_x, to_y, 0.2};
    return job;
  }
  static void expect_joined(const JointPath& a, const JointPath& b) {
    EXPECT_NEAR((a.back() - b.front()).norm(), 0.0, 1e-12);
  }
  Eigen::Vector3d tool(const Eigen::VectorXd& q) const { return tool_pose(arm_.chain, q).translation(); }

  ArmModel arm_ = read_arm(VISUM_SOURCE_DIR "/models/amtec_arm/amtec_arm.urdf");
  Eigen::VectorXd start_;
};

TEST_F(Plans, LeadFromTheStartToBoxAndGoalAndBack) {
  const Plan plan = make_plan(arm_, start_, job(0.5, 0.2, 0.5, -0.2));
  EXPECT_EQ(plan.to_box.front().front(), start_);
  expect_joined(plan.to_box.back(), plan.to_grasp);
  expect_joined(plan.to_grasp, plan.lift);
  expect_joined(plan.lift, plan.carry.front());
  expect_joined(plan.carry.back(), plan.put_down);
  expect_joined(plan.put_down, plan.retreat);
  expect_joined(plan.retreat, plan.home.front());
  EXPECT_NEAR((plan.home.back().back() - start_).norm(), 0.0, 1e-12);
}

TEST_F(Plans, PutTheToolAtTheMiddleOfTheBoxAndLiftItStraight) {
  const Plan plan = make_plan(arm_, start_, job(0.5, 0.2, 0.5, -0.2));
  EXPECT_NEAR((tool(plan.to_grasp.back()) - Eigen::Vector3d(0.5, 0.2, 0.24)).norm(), 0.0, 1e-4);
  EXPECT_NEAR((tool(plan.lift.back()) - Eigen::Vector3d(0.5, 0.2, 0.36)).norm(), 0.0, 1e-4);
  EXPECT_NEAR((tool(plan.put_down.back()) - Eigen::Vector3d(0.5, -0.2, 0.241)).norm(), 0.0, 1e-4);
}

TEST_F(Plans, CarryTheBoxAboveTheTable) {
  const Plan plan = make_plan(arm_, start_, job(0.5, 0.2, 0.5, -0.2));
  for (const JointPath& leg : plan.carry) {
    for (const auto& q : leg) EXPECT_GT(tool(q).z(), 0.24 + 0.03);
  }
}

TEST_F(Plans, ReachAGridOfPlacesOnTheTable) {
  for (const double x : {0.40, 0.45, 0.50, 0.55, 0.60}) {
    for (const double y : {-0.25, -0.15, 0.0, 0.15, 0.25}) {
      EXPECT_NO_THROW(make_plan(arm_, start_, job(x, y, 0.5, -0.2))) << x << " " << y;
      EXPECT_NO_THROW(make_plan(arm_, start_, job(0.5, 0.2, x, y))) << x << " " << y;
    }
  }
}

TEST_F(Plans, KeepTheBoxUprightFromGraspToGoal) {
  for (const Job& task :
       {job(0.42, 0.15, 0.55, -0.10), job(0.58, 0.0, 0.42, -0.25), job(0.45, -0.22, 0.52, 0.24)}) {
    const Plan plan = make_plan(arm_, start_, task);
    const Eigen::Matrix3d R_grasp = tool_pose(arm_.chain, plan.to_grasp.back()).linear();
    const Eigen::Matrix3d R_put = tool_pose(arm_.chain, plan.put_down.back()).linear();
    const Eigen::Vector3d up =
        R_put * R_grasp.transpose() * Eigen::Vector3d::UnitZ();  // the box's, at the goal
    EXPECT_NEAR((up - Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-3);
  }
}

TEST_F(Plans, TurnWithTheBox) {
  Job turned = job(0.5, 0.2, 0.5, -0.2);
  turned.yaw = 0.4;
  const Plan plan = make_plan(arm_, start_, turned);
  const Eigen::Vector3d closing = tool_pose(arm_.chain, plan.to_grasp.back()).linear().col(1);
  const double along = std::abs(closing.dot(Eigen::Vector3d(-std::sin(0.4), std::cos(0.4), 0)));
  const double across = std::abs(closing.dot(Eigen::Vector3d(std::cos(0.4), std::sin(0.4), 0)));
  EXPECT_NEAR(std::max(along, across), 1.0, 1e-6);
}

void expect_unreachable(const ArmModel& arm, const Eigen::VectorXd& start, const Job& job, const char* word) {
  try {
    make_plan(arm, start, job);
    FAIL() << "should be unreachable";
  } catch (const Unreachable& error) {
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST_F(Plans, RefuseWhatIsOutOfReach) {
  expect_unreachable(arm_, start_, job(0.95, 0.2, 0.5, -0.2), "the box's place (0.950, 0.200, 0.200)");
  expect_unreachable(arm_, start_, job(0.5, 0.2, 0.5, -0.9), "the goal (0.500, -0.900, 0.200)");
}

TEST_F(Plans, RefuseABoxThatIsTooWideOrTooLow) {
  Job wide = job(0.5, 0.2, 0.5, -0.2);
  wide.width = 0.08;
  expect_unreachable(arm_, start_, wide, "wide");
  Job low = job(0.5, 0.2, 0.5, -0.2);
  low.height = 0.01;
  expect_unreachable(arm_, start_, low, "out of reach");
}

}  // namespace
}  // namespace visum::pick_and_place
