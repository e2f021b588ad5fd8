// Bodies that joints connect: a spanning tree of the joints that carry, and the others as loops on it. Solves
// for the velocities that close all its joints at once, and answers what an impulse anywhere in it does.
#pragma once

#include <span>

#include "server/dynamics/impulse/rank_cholesky.h"
#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {

// One scalar of relative motion inside a mechanism: the sum over both ends of w·angular + v·linear, v that of
// the centre of mass. An impulse on it pushes both ends along the same directions.
struct Line {
  int node_a = -1, node_b = -1;  // -1: what stands still
  Vector3d angular_a = Vector3d::Zero(), linear_a = Vector3d::Zero();
  Vector3d angular_b = Vector3d::Zero(), linear_b = Vector3d::Zero();
};

class Mechanism {
 public:
  // `joints` of one connected part of the world, parents first; `bodies` in the order of their numbers.
  Mechanism(const world::WorldModel& model, const Bodies& bodies, std::vector<int> body_numbers,
            const std::vector<world::JointId>& joints);

  std::size_t size() const { return tree_.size(); }
  std::size_t loop_count() const { return loops_.size(); }
  int body(std::size_t node) const { return tree_.node(node).body; }
  int node_of(int body) const;
  const JointSpec* carrying(std::size_t node) const;  // null: a free root
  const JointSpec& loop(std::size_t i) const { return loops_[i]; }
  const JointPose& pose(std::size_t node) const { return poses_[node]; }
  const JointPose& loop_pose(std::size_t i) const { return loop_poses_[i]; }
  const Motion& motion(std::size_t node) const { return motions_[node]; }

  // Poses, directions and factors at t. Does nothing where neither bodies nor axes have changed since.
  void factor(const Bodies& bodies, const world::WorldState& state);
  std::vector<TreeAxis> axes;  // by node; read by factor()

  // The largest gap that the look-ahead finds, and the request that would close it in h.
  double ask_gaps(const Bodies& bodies, const world::WorldState& state, double h);
  // The request that makes the joints' velocities agree; returns the largest disagreement.
  double ask_velocities(const Bodies& bodies);
  // Which joint's gap the last ask_gaps() found to be the largest; null where no joint is.
  const JointSpec* worst_joint() const { return worst_; }

  void clear();
  void push(const Line& line, double impulse);
  Tree& tree() { return tree_; }
  const Tree& tree() const { return tree_; }
  // Answers what has been asked and pushed since clear(), loops included.
  void solve();
  double rate(const Line& line) const;  // in the answer
  void apply(Bodies& bodies) const;     // the answer to the bodies' velocities

 private:
  struct LoopRow {
    Line line;
    double wanted = 0.0;
  };

  bool is_factored(const Bodies& bodies) const;
  void remember(const Bodies& bodies);
  void factor_loops(const Bodies& bodies);
  double note_gap(const Gap& gap, const JointSpec& joint, double largest);

  Tree tree_;
  std::vector<JointSpec> specs_;  // by node; of a free root unused
  std::vector<JointPose> poses_;
  std::vector<Motion> motions_;
  std::vector<JointSpec> loops_;
  std::vector<JointPose> loop_poses_;
  std::vector<Held> loop_held_;
  std::vector<LoopRow> loop_rows_;
  std::size_t loop_row_count_ = 0;
  RankCholesky loop_factor_;
  std::vector<double> loop_errors_;
  const JointSpec* worst_ = nullptr;

  // What the factors were made of.
  bool factored_ = false;
  std::vector<Vector3d> factored_x_;
  std::vector<Eigen::Vector4d> factored_q_;
  std::vector<TreeAxis> factored_axes_;
};

// All of an engine's bodies that are jointed to anything, by connected parts; what is left stands free.
std::vector<Mechanism> find_mechanisms(const world::WorldModel& model, const Bodies& bodies);

// A relative motion (w, v) at P between two bodies of a mechanism, as a line.
Line line_at(const Mechanism& mechanism, const Bodies& bodies, int body_a, int body_b, const Vector3d& p,
             const Vector3d& w, const Vector3d& v);

}  // namespace visum::dynamics::impulse
