#include "clients/examples/pick_and_place/plan.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "clients/examples/pick_and_place/inverse_kinematics.h"

namespace visum::pick_and_place {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTilts[] = {90 * kDegree, 75 * kDegree, 60 * kDegree, 45 * kDegree, 30 * kDegree};
constexpr double kFingertipClearance_m = 0.006;  // to the surface, while the fingers hold the box
constexpr double kHalfPadWidth_m = 0.011;
constexpr double kReleaseGap_m = 0.001;     // the box is let go this far above its goal
constexpr double kElbowClearance_m = 0.07;  // from a joint's middle to the surface below
constexpr double kCarryClearance_m = 0.03;  // of the box, above the surface
constexpr double kLeastDexterity = 0.04;    // smallest singular value of the Jacobian (m and rad mixed)
constexpr std::size_t kPosturesPerApproach = 2;
constexpr double kWaySample_rad = 0.05;

// The grip on the box. It is the same at both places; otherwise the box would not stand upright at the second
// one.
struct Grip {
  double tilt;   // below the horizontal
  bool flipped;  // turned by half a turn about its own axis: the fingers swap sides
};

struct Place {
  Eigen::Vector3d foot;  // of the box
  const char* name;
  double gap;            // extra height of the tool
  bool reached = false;  // with some grip
};

// The gripper holds as `grip` says and points towards `azimuth`.
Eigen::Matrix3d orientation(const Grip& grip, double azimuth) {
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  Eigen::Matrix3d R;
  R.col(2) = Eigen::Vector3d(c * std::cos(grip.tilt), s * std::cos(grip.tilt), -std::sin(grip.tilt));
  R.col(1) = (grip.flipped ? -1.0 : 1.0) * Eigen::Vector3d(-s, c, 0.0);
  R.col(0) = R.col(1).cross(R.col(2));
  return R;
}

class Planner {
 public:
  Planner(const ArmModel& arm, const Eigen::VectorXd& start, const Job& job)
      : arm_(arm), start_(start), job_(job), surface_(std::max(job.from.z(), job.to.z())) {}

  Plan plan() const;

 private:
  std::optional<Plan> plan_with(const Grip& grip, Place& box, Place& goal) const;
  std::vector<JointPath> ways_down(Place& place, const Grip& grip) const;
  std::vector<double> azimuths(const Eigen::Vector3d& foot) const;
  std::optional<double> grip_height(double tilt) const;
  bool is_clear(const JointPath& path, double least_tool_z) const;
  bool posture_is_clear(const Eigen::VectorXd& angles, double least_tool_z) const;
  std::optional<Way> way(const Eigen::VectorXd& from, const Eigen::VectorXd& to, double least_tool_z) const;

  const ArmModel& arm_;
  const Eigen::VectorXd& start_;
  const Job& job_;
  double surface_;  // the higher one of the two
};

// The height of the tool above the box's foot: the box's middle, or higher if the fingers would touch the
// surface.
std::optional<double> Planner::grip_height(double tilt) const {
  const double fingers_below = arm_.tip_reach_m * std::sin(tilt) + kHalfPadWidth_m * std::cos(tilt);
  const double height = std::max(0.5 * job_.height, fingers_below + kFingertipClearance_m);
  if (height > job_.height) return std::nullopt;
  return height;
}

// The four sides of the box, the one that lets the gripper point away from the base first.
std::vector<double> Planner::azimuths(const Eigen::Vector3d& foot) const {
  const double outward = std::atan2(foot.y(), foot.x());
  std::vector<double> all;
  for (int quarter = 0; quarter < 4; ++quarter) all.push_back(job_.yaw + quarter * 90 * kDegree);
  std::stable_sort(all.begin(), all.end(), [outward](double a, double b) {
    return std::cos(a - outward) > std::cos(b - outward) + 1e-9;
  });
  return all;
}

// The smallest singular value: how much the tool moves at least for a motion of the joints.
double dexterity(const Jacobian& J) {
  const Eigen::Matrix<double, 6, 6> JJ = J * J.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(JJ, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

bool Planner::posture_is_clear(const Eigen::VectorXd& angles, double least_tool_z) const {
  const ToolMotion motion = tool_motion(arm_.chain, angles);
  if (motion.X_BT.translation().z() < least_tool_z) return false;
  if (dexterity(motion.J_BT) < kLeastDexterity) return false;
  const auto origins = joint_origins(arm_.chain, angles);
  // The shoulder cannot move. The elbow and everything beyond it must stay above the surface.
  return std::all_of(origins.begin() + std::min<std::ptrdiff_t>(3, std::ssize(origins)), origins.end(),
                     [this](const Eigen::Vector3d& p) { return p.z() > surface_ + kElbowClearance_m; });
}

bool Planner::is_clear(const JointPath& path, double least_tool_z) const {
  return std::all_of(path.begin(), path.end(),
                     [&](const Eigen::VectorXd& angles) { return posture_is_clear(angles, least_tool_z); });
}

// From straight above the place down to it.
std::vector<JointPath> Planner::ways_down(Place& place, const Grip& grip) const {
  constexpr std::size_t kEnough = 3;
  std::vector<JointPath> ways;
  const auto height = grip_height(grip.tilt);
  if (!height) return ways;
  Eigen::VectorXd rest = start_;
  rest[0] = std::atan2(place.foot.y(), place.foot.x());
  for (const double azimuth : azimuths(place.foot)) {
    Eigen::Isometry3d X_down = Eigen::Isometry3d::Identity();
    X_down.linear() = orientation(grip, azimuth);
    X_down.translation() = place.foot + Eigen::Vector3d(0.0, 0.0, *height + place.gap);
    Eigen::Isometry3d X_up = X_down;
    X_up.translation().z() += job_.lift;
    for (const Eigen::VectorXd& above : solve_all(arm_.chain, X_up, rest, kPosturesPerApproach)) {
      JointPath down = follow_line(arm_.chain, above, X_down, rest);
      if (!down.empty() && is_clear(down, place.foot.z())) ways.push_back(std::move(down));
    }
    if (ways.size() >= kEnough) break;
  }
  place.reached = place.reached || !ways.empty();
  return ways;
}

[[noreturn]] void fail(const Place& place, double lift) {
  char text[200];
  std::snprintf(
      text, sizeof text,
      "%s (%.3f, %.3f, %.3f) is out of reach: no posture within the joints' limits holds the box there and "
      "%.0f mm above, with the gripper pointing down by 30 to 90 degrees",
      place.name, place.foot.x(), place.foot.y(), place.foot.z(), 1e3 * lift);
  throw Unreachable(text);
}

JointPath straight(const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  const int steps = std::max(1, int(std::ceil((to - from).cwiseAbs().maxCoeff() / kWaySample_rad)));
  JointPath path;
  for (int i = 0; i <= steps; ++i) path.push_back(from + double(i) / steps * (to - from));
  return path;
}

// A path through the air: straight in joint space, or by way of the start posture if that would come too low.
std::optional<Way> Planner::way(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                                double least_tool_z) const {
  // The ends are not checked: the start is given, and the others were checked with their lines.
  const auto clear_between = [&](const JointPath& path) {
    return is_clear({path.begin() + 1, path.end() - 1}, least_tool_z);
  };
  const JointPath direct = straight(from, to);
  if (clear_between(direct)) return Way{direct};
  const Way detour{straight(from, start_), straight(start_, to)};
  if (clear_between(detour[0]) && clear_between(detour[1])) return detour;
  return std::nullopt;
}

std::optional<Plan> Planner::plan_with(const Grip& grip, Place& box, Place& goal) const {
  const auto down_to_box = ways_down(box, grip);
  const auto down_to_goal = ways_down(goal, grip);
  const double least_tool_z = surface_ + grip_height(grip.tilt).value_or(0.0) + kCarryClearance_m;
  for (const JointPath& grasp : down_to_box) {
    const auto there = way(start_, grasp.front(), least_tool_z);
    if (!there) continue;
    for (const JointPath& put : down_to_goal) {
      const auto carry = way(grasp.front(), put.front(), least_tool_z);
      const auto home = way(put.front(), start_, least_tool_z);
      if (!carry || !home) continue;
      const JointPath lift{grasp.rbegin(), grasp.rend()};
      const JointPath retreat{put.rbegin(), put.rend()};
      return Plan{*there, grasp, lift, *carry, put, retreat, *home, grip.tilt};
    }
  }
  return std::nullopt;
}

// The steepest first.
Plan Planner::plan() const {
  Place box{job_.from, "the box's place", 0.0};
  Place goal{job_.to, "the goal", kReleaseGap_m};
  for (const double tilt : kTilts) {
    for (const bool flipped : {false, true}) {
      if (const auto plan = plan_with({tilt, flipped}, box, goal)) return *plan;
    }
  }
  for (const Place& place : {box, goal}) {
    if (!place.reached) fail(place, job_.lift);
  }
  throw Unreachable(
      "both places can be reached, but not with one grip and on a way that keeps clear of the table");
}

void check_box(const ArmModel& arm, const Job& job) {
  double opening = 0.0;
  for (const Finger& finger : arm.fingers) opening += finger.upper;
  if (job.width >= opening) {
    throw Unreachable("the box is " + std::to_string(job.width) + " m wide, the gripper opens to " +
                      std::to_string(opening) + " m");
  }
}

}  // namespace

Plan make_plan(const ArmModel& arm, const Eigen::VectorXd& start, const Job& job) {
  check_box(arm, job);
  return Planner(arm, start, job).plan();
}

}  // namespace visum::pick_and_place
