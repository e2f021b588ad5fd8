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

// How the gripper comes to a place: pointing down by `tilt`, towards `azimuth`.
struct Approach {
  double tilt;
  double azimuth;
  bool flipped;  // turned by half a turn about its own axis: the fingers swap sides
};

struct Place {
  Eigen::Vector3d foot;  // of the box
  const char* name;
  double gap;  // extra height of the tool
};

// A way to be at a place, from straight above.
struct Visit {
  JointPath down;
  double tilt;
};

Eigen::Matrix3d orientation(const Approach& approach) {
  const double c = std::cos(approach.azimuth), s = std::sin(approach.azimuth);
  Eigen::Matrix3d R;
  R.col(2) =
      Eigen::Vector3d(c * std::cos(approach.tilt), s * std::cos(approach.tilt), -std::sin(approach.tilt));
  R.col(1) = (approach.flipped ? -1.0 : 1.0) * Eigen::Vector3d(-s, c, 0.0);
  R.col(0) = R.col(1).cross(R.col(2));
  return R;
}

class Planner {
 public:
  Planner(const ArmModel& arm, const Eigen::VectorXd& start, const Job& job)
      : arm_(arm), start_(start), job_(job), surface_(std::max(job.from.z(), job.to.z())) {}

  Plan plan() const;

 private:
  std::vector<Visit> visits(const Place& place) const;
  std::vector<Approach> approaches(const Eigen::Vector3d& foot) const;
  void add_visits(const Place& place, const Approach& approach, std::vector<Visit>& visits) const;
  std::optional<double> grip_height(double tilt) const;
  bool is_clear(const JointPath& path, double least_tool_z) const;
  bool posture_is_clear(const Eigen::VectorXd& angles, double least_tool_z) const;
  std::optional<Way> way(const Eigen::VectorXd& from, const Eigen::VectorXd& to, double least_tool_z) const;

  const ArmModel& arm_;
  const Eigen::VectorXd& start_;
  const Job& job_;
  double surface_;  // the higher one of the two
};

// Of the tool above the box's foot: the box's middle, or higher where the fingers would touch the surface.
std::optional<double> Planner::grip_height(double tilt) const {
  const double fingers_below = arm_.tip_reach_m * std::sin(tilt) + kHalfPadWidth_m * std::cos(tilt);
  const double height = std::max(0.5 * job_.height, fingers_below + kFingertipClearance_m);
  if (height > job_.height) return std::nullopt;
  return height;
}

// The steepest first; of equally steep ones, the one that points away from the base first.
std::vector<Approach> Planner::approaches(const Eigen::Vector3d& foot) const {
  const double outward = std::atan2(foot.y(), foot.x());
  std::vector<Approach> all;
  for (const double tilt : kTilts) {
    std::vector<Approach> of_tilt;
    for (int quarter = 0; quarter < 4; ++quarter) {
      for (const bool flipped : {false, true}) {
        of_tilt.push_back({tilt, job_.yaw + quarter * 90 * kDegree, flipped});
      }
    }
    std::stable_sort(of_tilt.begin(), of_tilt.end(), [outward](const Approach& a, const Approach& b) {
      return std::cos(a.azimuth - outward) > std::cos(b.azimuth - outward) + 1e-9;
    });
    all.insert(all.end(), of_tilt.begin(), of_tilt.end());
  }
  return all;
}

// The smallest singular value: how little the tool moves, at worst, for the joints' motion.
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
  // The shoulder stands where it stands; the elbow and what follows moves above the surface.
  return std::all_of(origins.begin() + std::min<std::ptrdiff_t>(3, std::ssize(origins)), origins.end(),
                     [this](const Eigen::Vector3d& p) { return p.z() > surface_ + kElbowClearance_m; });
}

bool Planner::is_clear(const JointPath& path, double least_tool_z) const {
  return std::all_of(path.begin(), path.end(),
                     [&](const Eigen::VectorXd& angles) { return posture_is_clear(angles, least_tool_z); });
}

void Planner::add_visits(const Place& place, const Approach& approach, std::vector<Visit>& visits) const {
  const auto height = grip_height(approach.tilt);
  if (!height) return;
  Eigen::Isometry3d X_down = Eigen::Isometry3d::Identity();
  X_down.linear() = orientation(approach);
  X_down.translation() = place.foot + Eigen::Vector3d(0.0, 0.0, *height + place.gap);
  Eigen::Isometry3d X_up = X_down;
  X_up.translation().z() += job_.lift;
  Eigen::VectorXd rest = start_;
  rest[0] = std::atan2(place.foot.y(), place.foot.x());
  for (const Eigen::VectorXd& above : solve_all(arm_.chain, X_up, rest, kPosturesPerApproach)) {
    JointPath down = follow_line(arm_.chain, above, X_down, rest);
    if (!down.empty() && is_clear(down, place.foot.z())) visits.push_back({std::move(down), approach.tilt});
  }
}

std::vector<Visit> Planner::visits(const Place& place) const {
  constexpr std::size_t kEnough = 4;
  std::vector<Visit> found;
  for (const Approach& approach : approaches(place.foot)) {
    add_visits(place, approach, found);
    if (found.size() >= kEnough) break;
  }
  if (!found.empty()) return found;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "%s (%.3f, %.3f, %.3f) is out of reach: no posture within the joints' limits holds the box there and "
      "%.0f mm above, with the gripper pointing down by 30 to 90 degrees",
      place.name, place.foot.x(), place.foot.y(), place.foot.z(), 1e3 * job_.lift);
  throw Unreachable(text);
}

JointPath straight(const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  const int steps = std::max(1, int(std::ceil((to - from).cwiseAbs().maxCoeff() / kWaySample_rad)));
  JointPath path;
  for (int i = 0; i <= steps; ++i) path.push_back(from + double(i) / steps * (to - from));
  return path;
}

// Through the air: straight in joint space, or by way of the start posture where that would come too low.
std::optional<Way> Planner::way(const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                                double least_tool_z) const {
  // The ends are where they are: the start is given, and the others were checked with their lines.
  const auto clear_between = [&](const JointPath& path) {
    return is_clear({path.begin() + 1, path.end() - 1}, least_tool_z);
  };
  const JointPath direct = straight(from, to);
  if (clear_between(direct)) return Way{direct};
  const Way detour{straight(from, start_), straight(start_, to)};
  if (clear_between(detour[0]) && clear_between(detour[1])) return detour;
  return std::nullopt;
}

Plan Planner::plan() const {
  const auto at_box = visits({job_.from, "the box's place", 0.0});
  const auto at_goal = visits({job_.to, "the goal", kReleaseGap_m});
  for (const Visit& box : at_box) {
    const double least_tool_z = surface_ + *grip_height(box.tilt) + kCarryClearance_m;
    for (const Visit& goal : at_goal) {
      const auto there = way(start_, box.down.front(), least_tool_z);
      const auto carry = way(box.down.front(), goal.down.front(), least_tool_z);
      const auto home = way(goal.down.front(), start_, least_tool_z);
      if (!there || !carry || !home) continue;
      const JointPath up{box.down.rbegin(), box.down.rend()};
      const JointPath away{goal.down.rbegin(), goal.down.rend()};
      return {*there, box.down, up, *carry, goal.down, away, *home, box.tilt, goal.tilt};
    }
  }
  throw Unreachable(
      "both places can be reached, but no way from the one to the other keeps clear of the table");
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
