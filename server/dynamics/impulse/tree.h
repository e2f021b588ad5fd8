// The articulated-impulse recursion. It finds the velocities that the bodies of a tree get from impulses on
// them and from relative velocities that are asked of their joints. The time grows linearly with the number
// of bodies.
//
// It is Featherstone's articulated-body algorithm (Rigid Body Dynamics Algorithms, 2008, chapter 7), with
// impulses and changes of velocity in place of forces and accelerations. Everything is in W, each body about
// the point P of the joint that carries it. Symbols, of node i with parent p:
//   c = x - P, r = P - P_p, S = (Sw, Sv) the joint's free directions, q' its rates
//   (A B; B^T C)   inertia of all that hangs on P:  f_w = A w + B v,  f_v = B^T w + C v
//   U = I S,  D = S^T U,  lambda the impulse on the axis, (beta, alpha) the relative velocity asked for
//   w = w_p + beta + Sw q',  v = v_p + w_p x r + alpha + Sv q'
// A joint with several free directions is treated as a chain of joints with one each, and nothing between
// them. An axis whose drive acts as  q' + k lambda = b  (k its compliance, b its target) has 1/(D + 1/k) in
// place of 1/D. This is hwparts/joint.h as a part of the tree; k = 0 locks the axis to b.
#pragma once

#include <span>
#include <vector>

#include "server/dynamics/impulse/joint_spec.h"
#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/dynamics/impulse/prediction.h"

namespace visum::dynamics::impulse {

// One body of the tree and the joint that carries it.
struct TreeNode {
  int body = -1;      // number among the engine's bodies
  int parent = -1;    // node; -1: a body that does not move, or nothing for a free root
  int joint = -1;     // index of its spec; -1: a free root
  int freedoms = 0;   // number of the joint's free directions
  double mass = 0.0;  // of the body, kg
};

// Order of calls: assign() once; per step factor(); then clear(), requests, solve(), answers any number of
// times. A Mechanism owns it; its thread. Nothing fails; numbers that are not finite come out as such.
class Tree {
 public:
  using VectorView = Eigen::Map<const Vector3d>;

  explicit Tree(const Kernels& by = kernels()) : kernels_(&by) {}

  // Takes the nodes, parents before children.
  void assign(std::vector<TreeNode> nodes);
  std::size_t size() const { return nodes_.size(); }
  const TreeNode& node(std::size_t i) const { return nodes_[i]; }
  // The part of a node: what hangs together without anything that does not move. An impulse on one part does
  // nothing to another.
  int part(std::size_t i) const { return part_of_[i]; }

  // Factors the tree, from the poses and inertias of `bodies`, the joints' poses and free directions by node,
  // and the drives' axes.
  void factor(const Bodies& bodies, const std::vector<JointPose>& poses, const std::vector<Motion>& free,
              const std::vector<TreeAxis>& axes);

  // The requests, by node; all zero after clear(). ask(): relative velocity (rad/s, m/s); push: impulses.
  void clear();
  void ask(std::size_t i, const Vector3d& beta, const Vector3d& alpha) {
    TreeAsked& asked = asked_[row_of_[i]];
    Eigen::Map<Vector3d>(asked.beta) = beta;
    Eigen::Map<Vector3d>(asked.alpha) = alpha;
  }
  // Where kernels write beta and alpha of the first node, and how many numbers further a node's are.
  Asks asks() { return {asked_[0].beta, asked_[0].alpha}; }
  long request(std::size_t i) const {
    return static_cast<long>(row_of_[i] * (sizeof(TreeAsked) / sizeof(double)));
  }
  void ask_axis(std::size_t i, double target) { asked_[row_of_[i]].target = target; }
  void push_axis(std::size_t i, double impulse) { asked_[row_of_[i]].axis_impulse += impulse; }
  void push_body(std::size_t i, const Vector3d& angular, const Vector3d& linear) {  // at its centre of mass
    TreeAsked& asked = asked_[row_of_[i]];
    Eigen::Map<Vector3d>(asked.angular) += angular;
    Eigen::Map<Vector3d>(asked.linear) += linear;
    asked.pushed = true;
  }

  void solve();

  // A place on the way of up to four impulses: an axis, or one coordinate of a free root. Each impulse gives
  // it something (N·s or N·m·s), and it answers with a velocity (m/s or rad/s).
  struct WayPoint {
    std::size_t place = 0;  // a row; behind the rows, six for each root
    Eigen::Vector4d given, answer;
  };

  // The response of unit impulses to each other (tree_response.cc). Order of calls, any time after factor():
  // begin_traces() with the number of impulses, trace() for all of them, find_response(). `W`: as many rows
  // and columns as there are impulses. An impulse has one or two ends, each made by push_at() (node -1: does
  // not move) or push_on_axis(). trace() takes up to four impulses whose ends are on the same nodes.
  TreePush push_at(int node, const Vector3d& angular, const Vector3d& linear) const;
  TreePush push_on_axis(std::size_t node) const;
  void begin_traces(std::size_t count);
  static constexpr std::size_t kMostTogether = 4;
  void trace(std::span<const TreePush> a, std::span<const TreePush> b);
  std::size_t step_count() const { return step_count_; }  // axes on all ways to the root
  void find_response(double* W);
  // Writes how each of them responds to impulse `lane` of another way.
  void find_responses_to(std::span<const WayPoint> way, int lane, double* to);

  // The same where most impulses have nothing to do with each other: each way is kept by itself.
  // Appends the way of up to four impulses, from the last place to the first.
  void trace(std::span<const TreePush> a, std::span<const TreePush> b, std::vector<WayPoint>& way);
  // Row i, column j: what the j-th impulse of way b does to the i-th of way a.
  static Eigen::Matrix4d response(std::span<const WayPoint> a, std::span<const WayPoint> b);

  // The answer, by node: changes of velocity of the centre of mass, and of a joint's single axis.
  VectorView dw(std::size_t i) const { return VectorView(answers_[row_of_[i]].w); }
  VectorView dv(std::size_t i) const { return VectorView(answers_[row_of_[i]].dv); }
  double axis_rate(std::size_t i) const { return answers_[row_of_[i]].rate; }
  // How many numbers behind the first node's answer a node's is.
  long answer(std::size_t i) const {
    return static_cast<long>(row_of_[i] * (sizeof(TreeAnswer) / sizeof(double)));
  }
  const TreeAnswer* answers() const { return answers_.data(); }
  // Impulse that an implicit drive has given in this solution, N·m·s or N·s.
  double axis_impulse(std::size_t i) const;
  // The largest change of velocity, m/s or rad/s.
  double largest_answer() const;

  // Adds the answer to the bodies' velocities.
  void apply(Bodies& bodies) const;
  // Does the same, and adds what the joints give in it to `given`, by node. A free root's share is only
  // rounding.
  void apply_and_note(Bodies& bodies, std::span<JointImpulse> given);

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  // A free root, whose six velocities are solved for directly.
  struct Root {
    std::size_t row = 0;
    Eigen::Matrix<double, 6, 6> inverse =
        Eigen::Matrix<double, 6, 6>::Identity();  // of the inertia of all that hangs on it
  };

  // The way of a unit impulse to the root: its rows are some of way_rows_.
  struct Way {
    std::size_t first = 0, count = 0;
  };
  // The response of impulse i to itself and to those before it.
  void find_responses_of(std::size_t i, double* to);

  // Adds the rows of a node: one for each free direction of its joint, at least one.
  void add_rows(std::size_t node);
  // Decides for each row where its load goes on the way from the tips to the root (TreeRow::Way).
  void find_ways();
  void find_parts();
  // Inverts a root's inertia, and finds its velocity from its load.
  void factor_root(Root& root);
  void spread_root(const Root& root);
  TreeData data();
  // How many places a way may lead through: the rows, and six for each root's load.
  std::size_t places() const { return rows_.size() + 6 * roots_.size(); }

  const Kernels* kernels_;
  std::vector<TreeNode> nodes_;
  std::vector<int> part_of_;  // by node
  std::vector<Root> roots_;
  std::vector<std::size_t> row_of_;  // by node: the row of its body
  std::vector<TreeRow> rows_;        // parents first
  // All by row.
  std::vector<TreeFactor> factors_;
  std::vector<TreeAsked> asked_;
  std::vector<TreeAnswer> answers_;
  std::vector<TreeLoad> loads_;
  // The ways of the impulses whose response is asked for. The matrix has a row for each place, and a column
  // for each impulse: its e there (tree_response.cc).
  std::vector<Way> ways_;
  std::vector<std::size_t> way_rows_, way_;  // of all ways; room for one
  std::vector<double> matrix_, on_way_;      // on_way_: room for four impulses
  std::size_t width_ = 0, step_count_ = 0;   // width_: of the matrix' rows
  std::vector<WayTerm> answers_of_way_;      // to one impulse: of each axis on its way, and of the root
};

}  // namespace visum::dynamics::impulse
