// Bodies that joints connect: a spanning tree of the joints that carry, and the others as loops on it. Solves
// for the velocities that close all its joints at once, and answers what an impulse anywhere in it does.
#pragma once

#include <span>

#include "server/dynamics/impulse/lanes/joints_data.h"
#include "server/dynamics/impulse/loop_factor.h"
#include "server/dynamics/impulse/prediction.h"
#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {

// One scalar of relative motion inside a mechanism: the sum over both ends of w·angular + v·linear, v that of
// the centre of mass. An impulse on it pushes both ends along the same directions.
struct PathMotion {
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
  std::span<const BodyBlock> blocks() const { return blocks_; }
  const JointSpec* carrying(std::size_t node) const {  // null: a free root
    return tree_.node(node).joint < 0 ? nullptr : &specs_[node];
  }
  const JointSpec& loop(std::size_t i) const { return loops_[i]; }
  const JointPose& pose(std::size_t node) const { return poses_[node]; }
  const JointPose& loop_pose(std::size_t i) const { return loop_poses_[i]; }
  const Motion& motion(std::size_t node) const { return motions_[node]; }

  // Poses and directions at t. False, and nothing done, where neither bodies nor axes have changed since.
  bool place(const Bodies& bodies, const world::WorldState& state);
  void forget_place() { placed_at_ = 0; }  // its bodies have moved
  // The factors there, if they are not yet made. What asks and answers below needs them.
  void factor(const Bodies& bodies);
  // How the drive of a node's axis takes part, from the next place() on.
  void set_axis(std::size_t node, const TreeAxis& axis) {
    if (axes_[node].implicit == axis.implicit && axes_[node].compliance == axis.compliance) return;
    axes_[node] = axis;
    axes_changed_ = true;
  }

  // Near a pose where its loops lose their grip: all bars of a four-bar on one line. As factored.
  bool is_nearly_singular() const;

  // Poses where the look-ahead has led, and the request that would close their gaps in h. Returns the largest
  // gap.
  double ask_gaps(const Bodies& bodies, const world::WorldState& state, double h);
  const JointPose& pose_ahead(std::size_t node) const { return poses_ahead_[node]; }
  const JointPose& loop_pose_ahead(std::size_t i) const { return loop_poses_ahead_[i]; }
  // The request that makes the joints' velocities agree.
  void ask_velocities(const Bodies& bodies);
  // Whose gap is the largest in those poses; null where no joint is.
  const JointSpec* worst_joint() const;

  void clear();
  void push(const PathMotion& line, double impulse);
  Tree& tree() { return tree_; }
  const Tree& tree() const { return tree_; }
  // Answers what has been asked and pushed since clear(), loops included.
  void solve();
  double rate(const PathMotion& line) const;  // in the answer
  double free_response(const PathMotion& line,
                       const Bodies& bodies) const;          // to itself, were nothing jointed
  void apply(Bodies& bodies) const { tree_.apply(bodies); }  // the answer to the bodies' velocities

  // What the joints will have to give at t (predicting.cc). Only where asked for, and of mechanisms without
  // loops.
  void start_predicting(const Bodies& bodies);
  bool predicts() const { return !prediction_.empty(); }
  Prediction& prediction() { return prediction_; }
  const Prediction& prediction() const { return prediction_; }
  // Foresees it, nothing along free directions; false where too little is known.
  bool predict(const Bodies& bodies);
  // On a node's one axis, what its free direction would go on to get, and what it is to get, N·m·s or N·s.
  double predicted_axis(std::size_t node) const { return foreseen_axis_[node]; }
  void push_predicted_axis(std::size_t node, double impulse) { add_along(node, 0, impulse); }
  void give_predicted(Bodies& bodies);
  // apply(), and the answer counts among what the joints give in this step, at its start or its end.
  void apply_ahead(Bodies& bodies);
  void apply_after(Bodies& bodies);
  // The largest change of velocity in the answer, m/s or rad/s, and the fastest turn.
  double largest_answer() const { return tree_.largest_answer(); }
  double largest_turn(const Bodies& bodies) const;
  // The look-ahead over h follows the answer, to first order.
  void nudge(Bodies& bodies, double h) const;
  // Whether what the joints give at t, over a step of length h, makes a link swing about a joint too fast for
  // such steps.
  bool is_too_taut(double h) const;

 private:
  struct LoopRow {
    PathMotion line;
    std::size_t loop = 0;
    double free_response = 0.0;  // were its bodies not jointed
    double wanted = 0.0;
  };

  void find_loop_neighbours();
  void place_loop_rows(const Bodies& bodies);
  void factor_loops();
  void find_response(std::size_t row, const std::array<int, 2>& parts);
  std::array<int, 2> parts(const JointSpec& loop) const;
  double rate_of_parts(const PathMotion& line, const std::array<int, 2>& parts) const;
  void find_blocks(const Bodies& bodies);
  std::vector<JointBlock> joint_blocks(const std::vector<std::size_t>& nodes, const Bodies& bodies) const;
  void add_along(std::size_t i, std::size_t k, double impulse);

  Tree tree_;
  std::vector<BodyBlock> blocks_;            // its bodies, by node
  std::vector<JointBlock> hinges_, others_;  // its carrying joints
  std::vector<std::size_t> other_nodes_, free_roots_;
  std::vector<JointEnds> ends_;
  std::vector<std::pair<int, int>> node_by_body_;  // body, node: sorted
  std::vector<JointSpec> specs_;                   // by node; of a free root unused
  std::vector<JointPose> poses_, poses_ahead_;
  std::vector<Motion> motions_;
  std::vector<JointSpec> loops_;
  std::vector<JointPose> loop_poses_, loop_poses_ahead_;
  std::vector<Held> loop_held_;
  std::vector<std::array<int, 2>> loop_parts_;  // of the tree, that a loop joins; -1: what stands still
  std::vector<std::size_t> first_neighbour_;    // by loop: the first loop that shares a part with it
  std::vector<LoopRow> loop_rows_;
  std::vector<std::size_t> first_loop_row_;  // by loop
  std::size_t loop_row_count_ = 0;
  LoopFactor loop_factor_;
  std::vector<double> loop_errors_;
  Prediction prediction_;
  std::vector<double> foreseen_axis_;
  std::vector<double> tautness_;  // by node: the square of a swing over the tension, 1/(kg·m)

  // What poses and factors were made of.
  bool of_bodies_alone_ = true;  // all its joints' poses
  bool factored_ = false;
  std::uint64_t placed_at_ = 0;  // of the bodies' placements; 0: nowhere
  std::vector<TreeAxis> axes_;   // by node
  bool axes_changed_ = false;
};

// All of an engine's bodies that are jointed to anything, by connected parts; what is left stands free.
std::vector<Mechanism> find_mechanisms(const world::WorldModel& model, const Bodies& bodies);

// A relative motion (w, v) at P between two bodies of a mechanism, as a line.
PathMotion line_at(const Mechanism& mechanism, const Bodies& bodies, int body_a, int body_b,
                   const Vector3d& p, const Vector3d& w, const Vector3d& v);

}  // namespace visum::dynamics::impulse
