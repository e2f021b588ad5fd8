// A mechanism: bodies that joints connect. Its joints form a spanning tree (tree.h) and, beyond that, loops
// (loops.cc). It solves for the velocities that close all of its joints at once, and answers what an impulse
// anywhere in it does.
#pragma once

#include <optional>
#include <span>

#include "server/dynamics/impulse/lanes/joints_data.h"
#include "server/dynamics/impulse/loop_factor.h"
#include "server/dynamics/impulse/prediction.h"
#include "server/dynamics/impulse/tree.h"
#include "server/dynamics/impulse/work_budget.h"

namespace visum::dynamics::impulse {

// One scalar of relative motion inside a mechanism: the sum over both ends of w·angular + v·linear, with v
// the velocity of the centre of mass. An impulse on it pushes both ends along the same directions.
struct PathMotion {
  int node_a = -1, node_b = -1;  // nodes of the tree; -1: does not move
  Vector3d angular_a = Vector3d::Zero(), linear_a = Vector3d::Zero();
  Vector3d angular_b = Vector3d::Zero(), linear_b = Vector3d::Zero();
};

// Two bodies of a mechanism by their numbers, -1: it does not move; and their nodes, -1: not in it.
struct PathEnds {
  int body_a = -1, body_b = -1, node_a = -1, node_b = -1;
};

// Order of calls in a step: place(), factor(), then clear(), requests (ask..., push), solve(), answers (rate,
// apply) any number of times. Plant owns it; its island's thread uses it. It does not fail: near a
// singular pose a loop's rows that explain each other are left out.
class Mechanism {
 public:
  // `joints` of one connected part of the world, parents first; `bodies` in the order of their numbers.
  Mechanism(const world::WorldModel& model, const Bodies& bodies, std::vector<int> body_numbers,
            const std::vector<world::JointId>& joints);

  std::size_t size() const { return tree_.size(); }
  std::size_t loop_count() const { return loops_.size(); }
  int body(std::size_t node) const { return tree_.node(node).body; }
  // Node of a body; -1: the body belongs to no node here.
  int node_of(int body) const;
  std::span<const BodyBlock> blocks() const { return blocks_; }
  const JointSpec* carrying(std::size_t node) const {  // null: a free root
    return tree_.node(node).joint < 0 ? nullptr : &specs_[node];
  }
  const JointSpec& loop(std::size_t i) const { return loops_[i]; }
  const PathEnds& loop_ends(std::size_t i) const { return loop_ends_[i]; }
  const JointPose& pose(std::size_t node) const { return poses_[node]; }
  const JointPose& loop_pose(std::size_t i) const { return poses_[size() + i]; }
  const Motion& motion(std::size_t node) const { return motions_[node]; }

  // Computes poses and directions at t. Returns false, having done nothing, where neither bodies nor axes
  // have changed since the last call.
  bool place(const Bodies& bodies, const world::WorldState& state);
  void forget_place() { placed_at_ = 0; }  // its bodies have moved
  // Computes the factors there, if they are not made yet. Requests and answers below need them.
  void factor(const Bodies& bodies);
  // Sets how the drive of a node's axis takes part, from the next place() on.
  void set_axis(std::size_t node, const TreeAxis& axis) {
    if (axes_[node].implicit == axis.implicit && axes_[node].compliance == axis.compliance) return;
    axes_[node] = axis;
    axes_changed_ = true;
  }

  // True if it is near a pose where its loops lose their grip, for example all bars of a four-bar on one
  // line. As factored.
  bool is_nearly_singular() const;
  // False already farther from such a pose: what the joints will give is not foreseen there.
  bool is_foreseeable() const;

  // Computes the poses that the look-ahead has reached, and asks for what would close their gaps in h.
  // Returns the largest gap, m or rad; NaN if one is NaN.
  double ask_gaps(const Bodies& bodies, const world::WorldState& state, double h);
  const JointPose& pose_ahead(std::size_t node) const { return poses_ahead_[node]; }
  const JointPose& loop_pose_ahead(std::size_t i) const { return poses_ahead_[size() + i]; }
  // Asks for what makes the joints' velocities agree.
  void ask_velocities(const Bodies& bodies);
  // The joint with the largest gap in those poses; null where there are no joints.
  const JointSpec* worst_joint() const;

  // Units of work (work_budget.h): of one pass over all joints, and of factoring them.
  std::uint64_t units() const { return pass_units_; }
  std::uint64_t factor_units() const { return pass_units_ + factor_units_; }

  // Forgets all requests.
  void clear();
  // Asks for an impulse (N·s or N·m·s) on a relative motion.
  void push(const PathMotion& line, double impulse);
  Tree& tree() { return tree_; }
  const Tree& tree() const { return tree_; }
  // Answers what has been asked and pushed since clear(), loops included.
  void solve();
  double rate(const PathMotion& line) const;  // in the answer, m/s or rad/s
  // `W`: the response that the tree alone found for all `n` impulses that it has followed since
  // begin_traces() (Tree::find_response). Takes away what the loops hold.
  void hold_responses(std::size_t n, double* W);
  // False where so many impulses are answered one by one in less work. As factored.
  bool holds_responses_cheaply(std::size_t n) const;
  double free_response(const PathMotion& line,
                       const Bodies& bodies) const;          // to itself, as if nothing were jointed
  void apply(Bodies& bodies) const { tree_.apply(bodies); }  // adds the answer to the bodies' velocities

  // The prediction of what the joints will give at t (predicting.cc). Only after start_predicting().
  void start_predicting(const Bodies& bodies);
  bool predicts() const { return !prediction_.empty(); }
  // Without predictions: notes what the joints give at t, so that is_too_taut() knows (only without loops).
  void start_noting(const Bodies& bodies);
  bool notes() const { return predicts() || !noted_.empty(); }
  // Starts a step of length h, or starts it again.
  void begin_step(double h);
  Prediction& prediction() { return prediction_; }
  const Prediction& prediction() const { return prediction_; }
  // Foresees the joints' impulses, nothing along free directions. Returns false where too little is known.
  bool predict(const Bodies& bodies);
  // On a node's one axis, N·m·s or N·s: the impulse that was foreseen along its free direction, and the one
  // that it is to get.
  double predicted_axis(std::size_t node) const { return foreseen_axis_[node]; }
  void push_predicted_axis(std::size_t node, double impulse) { add_along(node, 0, impulse); }
  // Gives the foreseen impulses to the bodies.
  void give_predicted(Bodies& bodies);
  // Like apply(), and counts the answer among what the joints give in this step, at its start or at its end.
  void apply_ahead(Bodies& bodies);
  void apply_after(Bodies& bodies);
  // The largest change of velocity in the answer (m/s or rad/s), and the fastest angular velocity (rad/s).
  double largest_answer() const { return tree_.largest_answer(); }
  double largest_turn(const Bodies& bodies) const;
  // Moves the look-ahead over h along with the answer, to first order.
  void nudge(Bodies& bodies, double h) const;
  // True if the tension that the joints give at t would make a link swing about a joint too far in a step of
  // length h.
  bool is_too_taut(double h, const Bodies& bodies, WorkBudget& work);

 private:
  // A direction that a loop's joint holds.
  struct LoopRow {
    PathMotion line;
    std::size_t loop = 0;
    double free_response = 0.0;  // as if its bodies were not jointed
    double wanted = 0.0;         // the velocity that is asked for, m/s or rad/s
  };

  void find_tautness(const Bodies& bodies);
  // The square over the tension: with all that hangs on the link, or of it alone, whichever is less.
  double square_of_swing_together(std::size_t node, const Bodies& bodies);
  // Finds what a pass and a factor cost.
  void count_units();
  // Finds, for each loop, the first loop that shares a part of the tree with it.
  void find_loop_neighbours();
  // The normal of the plane that a loop moves in, in B's P axes (planar_loops.cc); zero: it has none.
  Vector3d find_normal(std::size_t loop) const;
  Vector3d first_hinge_above(int node, int end) const;
  std::optional<Vector3d> follow_normal(int node, Vector3d normal, int end) const;
  int meeting_of(int a, int b) const;
  bool is_planar(std::size_t loop) const { return !loop_normals_[loop].isZero(0.0); }
  // The directions that its joint holds in the present pose: those that the tree can move.
  Held held_by_loop(std::size_t loop) const;
  // Computes the rows of all loops in the present poses.
  void place_loop_rows(const Bodies& bodies);
  // Makes and factors G T^-1 G^T (loops.cc).
  void factor_loops();
  // Rows of a loop whose ways through the tree are followed together, as far as they are solved for.
  struct Bundle {
    std::size_t way = 0, places = 0;               // where the way begins in loop_ways_, and its length
    std::size_t first = 0, rows = 0;               // in solved_rows_
    std::array<int, Tree::kMostTogether> lanes{};  // of these rows
  };
  void trace_loop(std::size_t loop);
  Eigen::Matrix4d response(const Bundle& a, const Bundle& b) const;
  // Fills the loops' system.
  void enter(const Bundle& a, const Bundle& b, const Eigen::Matrix4d& W);
  // The parts of the tree that a loop joins.
  std::array<int, 2> parts(const PathEnds& loop) const;
  // Groups bodies and joints in blocks of four for the kernels.
  void find_blocks(const Bodies& bodies);
  std::vector<JointBlock> joint_blocks(const std::vector<std::size_t>& nodes, const Bodies& bodies) const;
  // Adds an impulse along free direction k of node i to the foreseen ones.
  void add_along(std::size_t i, std::size_t k, double impulse);
  // Leaves of a loop's foreseen impulse the share along the rows that are solved for.
  void hold_foreseen(std::size_t loop);
  void apply_and_note(Bodies& bodies, std::span<JointImpulse> given);
  void add_ends(const JointSpec& spec, std::size_t place, const Bodies& bodies);

  Tree tree_;
  std::vector<BodyBlock> blocks_;            // its bodies, by node
  std::vector<JointBlock> hinges_, others_;  // the joints of the tree: hinges, and all other kinds
  std::vector<std::size_t> other_nodes_, free_roots_;
  // For the kernels: the two bodies of each joint, those of loops behind the others.
  std::vector<JointEnds> ends_;
  std::vector<std::pair<int, int>> node_by_body_;  // body, node: sorted
  std::vector<JointSpec> specs_;                   // by node; unused for a free root
  std::vector<JointPose> poses_, poses_ahead_;     // by node, then by loop
  std::vector<Motion> motions_;
  std::vector<JointSpec> loops_;
  std::vector<Held> loop_held_;
  std::vector<PathEnds> loop_ends_;
  std::vector<Vector3d> loop_normals_;  // find_normal(), by loop
  std::vector<std::array<int, 2>>
      loop_parts_;  // by loop: the parts of the tree that it joins; -1: does not move
  std::vector<std::size_t> first_neighbour_;  // by loop: the first loop that shares a part with it
  std::vector<LoopRow> loop_rows_;
  std::vector<std::size_t> first_loop_row_;  // by loop, and behind the last one
  std::size_t loop_row_count_ = 0;
  std::vector<std::size_t> solved_rows_;  // the rows that the loops' system has
  std::vector<Bundle> bundles_;
  std::vector<std::size_t> first_solved_;  // by loop, and behind the last one
  std::vector<std::size_t> first_bundle_;  // by loop
  std::vector<Tree::WayPoint> loop_ways_;
  LoopFactor loop_factor_;
  std::vector<double> loop_errors_;  // by solved row: what is missing; after solve() the impulse
  std::vector<double> held_;         // by solved row: what each of the impulses followed does to it
  std::uint64_t pass_units_ = 0, factor_units_ = 0;
  Prediction prediction_;
  std::vector<double> foreseen_axis_;
  std::vector<JointImpulse> noted_;  // by node: what the joints give at t, without predictions
  std::vector<double> tautness_;     // by node: square of a swing's frequency over the tension, 1/(kg·m)
  std::vector<Tree::WayPoint> swing_way_;  // of square_of_swing_together()
  std::vector<char> hangs_;                // likewise, by node

  // The state of the bodies that poses and factors belong to.
  bool of_bodies_alone_ = true;  // the poses of all its joints follow from the bodies alone
  bool factored_ = false;
  std::uint64_t placed_at_ = 0;  // Bodies::placements(); 0: nowhere
  std::vector<TreeAxis> axes_;   // by node
  bool axes_changed_ = false;
};

// Finds the connected parts of an engine's bodies. Bodies without any joint are in none.
std::vector<Mechanism> find_mechanisms(const world::WorldModel& model, const Bodies& bodies);

// The relative motion (w, v) at P between two bodies of a mechanism, as a line.
PathMotion line_at(const PathEnds& ends, const Bodies& bodies, const Vector3d& p, const Vector3d& w,
                   const Vector3d& v);

}  // namespace visum::dynamics::impulse
