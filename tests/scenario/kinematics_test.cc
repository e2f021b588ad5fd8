// The example controller's kinematics, without a server: against known points and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "clients/examples/pick_and_place/inverse_kinematics.h"
#include "clients/examples/pick_and_place/kinematics.h"

namespace visum::pick_and_place {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kUpperArm = 0.328, kForearm = 0.2765,
                 kHand = 0.1825 + 0.150;  // m; the last one to the pads' middle

const std::string kUrdf = VISUM_SOURCE_DIR "/models/amtec_arm/amtec_arm.urdf";

Eigen::VectorXd angles(std::initializer_list<double> values) {
  Eigen::VectorXd all(Eigen::Index(values.size()));
  std::copy(values.begin(), values.end(), all.data());
  return all;
}

class Kinematics : public testing::Test {
 protected:
  ArmModel arm_ = read_arm(kUrdf);
  const Chain& chain_ = arm_.chain;
};

TEST_F(Kinematics, ReadsSevenJointsAndTwoFingersFromTheUrdf) {
  ASSERT_EQ(chain_.joints.size(), 7u);
  EXPECT_EQ(chain_.joints[6].name, "joint_7");
  EXPECT_NEAR(chain_.joints[1].upper, 130.0 / 180.0 * kPi, 1e-6);
  EXPECT_DOUBLE_EQ(chain_.joints[3].max_speed, 0.559);
  ASSERT_EQ(arm_.fingers.size(), 2u);
  EXPECT_EQ(arm_.fingers[0].name, "finger_left_joint");
  EXPECT_DOUBLE_EQ(arm_.fingers[0].upper, 0.0342);
  EXPECT_NEAR(arm_.tip_reach_m, 0.018, 1e-12);
}

TEST_F(Kinematics, StandsStraightUpAtZero) {
  const Eigen::Isometry3d X = tool_pose(chain_, Eigen::VectorXd::Zero(7));
  EXPECT_TRUE(X.translation().isApprox(Eigen::Vector3d(0, 0, 0.300 + kUpperArm + kForearm + kHand), 1e-12));
  EXPECT_TRUE(X.linear().isApprox(Eigen::Matrix3d::Identity(), 1e-9));
}

TEST_F(Kinematics, BendsForwardWithPositiveAnglesOfTheEvenJoints) {
  // A planar arm in the x-z plane: each even joint adds to the tilt from the vertical.
  const double a = 0.3, b = 0.9, c = 0.7;
  const Eigen::Isometry3d X = tool_pose(chain_, angles({0, a, 0, b, 0, c, 0}));
  const double x = kUpperArm * std::sin(a) + kForearm * std::sin(a + b) + kHand * std::sin(a + b + c);
  const double z = 0.300 + kUpperArm * std::cos(a) + kForearm * std::cos(a + b) + kHand * std::cos(a + b + c);
  EXPECT_NEAR((X.translation() - Eigen::Vector3d(x, 0, z)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((X.linear().col(2) - Eigen::Vector3d(std::sin(a + b + c), 0, std::cos(a + b + c))).norm(), 0.0,
              1e-9);
}

TEST_F(Kinematics, TurnsAboutTheVerticalWithJointOne) {
  const Eigen::Isometry3d X0 = tool_pose(chain_, angles({0, 0.5, 0, 1.0, 0, 0.5, 0}));
  const Eigen::Isometry3d X1 = tool_pose(chain_, angles({0.8, 0.5, 0, 1.0, 0, 0.5, 0}));
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_NEAR((R * X0.translation() - X1.translation()).norm(), 0.0, 1e-12);
}

TEST_F(Kinematics, OpensTheFingersAlongTheToolsY) {
  const Eigen::Isometry3d X = tool_pose(chain_, Eigen::VectorXd::Zero(7));
  EXPECT_NEAR((X.linear().col(1) - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-9);
}

TEST_F(Kinematics, JacobianIsTheDerivativeOfThePose) {
  const Eigen::VectorXd q = angles({0.3, -0.4, 0.5, 1.2, -0.6, 0.9, 0.2});
  const ToolMotion motion = tool_motion(chain_, q);
  const double h = 1e-6;
  for (Eigen::Index i = 0; i < 7; ++i) {
    Eigen::VectorXd before = q, after = q;
    before[i] -= h;
    after[i] += h;
    const auto difference = pose_difference(tool_pose(chain_, before), tool_pose(chain_, after));
    EXPECT_NEAR((difference / (2 * h) - motion.J_BT.col(i)).norm(), 0.0, 1e-7) << "joint " << i + 1;
  }
}

TEST_F(Kinematics, JointOriginsMeetInShoulderElbowAndWrist) {
  const auto origins = joint_origins(chain_, angles({0.3, -0.4, 0.5, 1.2, -0.6, 0.9, 0.2}));
  EXPECT_NEAR((origins[1] - origins[0]).norm(), 0.0, 1e-12);
  EXPECT_NEAR((origins[3] - origins[2]).norm(), 0.0, 1e-12);
  EXPECT_NEAR((origins[3] - origins[1]).norm(), kUpperArm, 1e-12);
  EXPECT_NEAR((origins[5] - origins[3]).norm(), kForearm, 1e-12);
  EXPECT_NEAR((origins[6] - origins[5]).norm(), 0.1825, 1e-12);
}

class InverseKinematics : public Kinematics {
 protected:
  const Eigen::VectorXd rest_ = angles({0, -0.4, 0, 1.6, 0, 1.4, 0});

  // Tool pointing down by `tilt`, in +x.
  static Eigen::Isometry3d pose(double x, double y, double z, double tilt) {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear().col(2) = Eigen::Vector3d(std::cos(tilt), 0, -std::sin(tilt));
    X.linear().col(1) = Eigen::Vector3d::UnitY();
    X.linear().col(0) = X.linear().col(1).cross(X.linear().col(2));
    X.translation() = Eigen::Vector3d(x, y, z);
    return X;
  }

  void expect_reached(const Eigen::VectorXd& q, const Eigen::Isometry3d& X) const {
    const auto difference = pose_difference(tool_pose(chain_, q), X);
    EXPECT_LT(difference.head<3>().norm(), 1e-4);
    EXPECT_LT(difference.tail<3>().norm(), 1e-3);
    for (std::size_t i = 0; i < chain_.joints.size(); ++i) {
      EXPECT_GE(q[Eigen::Index(i)], chain_.joints[i].lower + kLimitMargin_rad - 1e-12)
          << chain_.joints[i].name;
      EXPECT_LE(q[Eigen::Index(i)], chain_.joints[i].upper - kLimitMargin_rad + 1e-12)
          << chain_.joints[i].name;
    }
  }
};

TEST_F(InverseKinematics, ReachesAGridOverTheTableWithinATenthOfAMillimetre) {
  for (double x = 0.40; x < 0.56; x += 0.05) {
    for (double y = -0.25; y < 0.26; y += 0.05) {
      for (const double z : {0.24, 0.36}) {
        const Eigen::Isometry3d X = pose(x, y, z, kPi / 3);
        const auto solutions = solve_all(chain_, X, rest_);
        ASSERT_FALSE(solutions.empty()) << x << " " << y << " " << z;
        for (const auto& solution : solutions) expect_reached(solution, X);
      }
    }
  }
}

TEST_F(InverseKinematics, FindsEveryPoseThatAPostureMakes) {
  // Postures spread over the middle of the joints' ranges; deterministic.
  for (int k = 1; k <= 60; ++k) {
    Eigen::VectorXd q(7);
    for (int i = 0; i < 7; ++i) q[i] = 1.6 * std::sin(1.7 * k * (i + 1) + i);
    const Eigen::Isometry3d X = tool_pose(chain_, q);
    const auto solutions = solve_all(chain_, X, rest_);
    ASSERT_FALSE(solutions.empty()) << "posture " << k << ": " << q.transpose();
    expect_reached(solutions.front(), X);
  }
}

TEST_F(InverseKinematics, SaysNoBeyondTheReach) {
  EXPECT_TRUE(solve_all(chain_, pose(1.2, 0.0, 0.3, kPi / 2), rest_).empty());
  EXPECT_FALSE(solve_from(chain_, pose(0.5, 0.2, 0.24, kPi / 2 + 3.0), rest_, rest_).has_value());
}

TEST_F(InverseKinematics, PutsTheSolutionNearestToTheRestPostureFirst) {
  const auto solutions = solve_all(chain_, pose(0.5, 0.0, 0.3, kPi / 3), rest_);
  ASSERT_GE(solutions.size(), 2u);
  for (std::size_t i = 1; i < solutions.size(); ++i) {
    EXPECT_LE((solutions[i - 1] - rest_).norm(), (solutions[i] - rest_).norm());
  }
}

TEST_F(InverseKinematics, FollowsAStraightLine) {
  const Eigen::Isometry3d X_up = pose(0.5, 0.2, 0.36, kPi / 3);
  const Eigen::Isometry3d X_down = pose(0.5, 0.2, 0.24, kPi / 3);
  const auto above = solve_all(chain_, X_up, rest_);
  ASSERT_FALSE(above.empty());
  const auto line = follow_line(chain_, above.front(), X_down, rest_, 0.005);
  ASSERT_EQ(line.size(), 25u);  // 0.12 m in steps of 5 mm, with both ends
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    // Also between the points, where the joints go straight.
    const Eigen::Vector3d p = tool_pose(chain_, 0.5 * (line[i] + line[i + 1])).translation();
    EXPECT_NEAR(p.x(), 0.5, 1e-4);
    EXPECT_NEAR(p.y(), 0.2, 1e-4);
    EXPECT_LT((line[i + 1] - line[i]).cwiseAbs().maxCoeff(), 0.1);
  }
  expect_reached(line.back(), X_down);
}

TEST_F(InverseKinematics, GivesNoLineThatLeavesTheReach) {
  const auto start = solve_all(chain_, pose(0.5, 0.0, 0.3, kPi / 3), rest_);
  ASSERT_FALSE(start.empty());
  EXPECT_TRUE(follow_line(chain_, start.front(), pose(1.1, 0.0, 0.3, kPi / 3), rest_).empty());
}

TEST(ReadArm, NamesTheFileThatIsMissing) {
  try {
    read_arm("/nowhere/arm.urdf");
    FAIL() << "should have thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/arm.urdf"), std::string::npos);
  }
}

}  // namespace
}  // namespace visum::pick_and_place
