// The articulated-impulse recursion: which velocities the bodies of a tree get from impulses on them and from
// relative velocities that are asked of their joints, in time that grows with their number.
//
// Featherstone's articulated-body algorithm (Rigid Body Dynamics Algorithms, 2008, chapter 7) with impulses
// and changes of velocity in place of forces and accelerations, in W, each body about the point P of the
// joint that carries it. Symbols, of node i with parent p:
//   c = x - P, r = P - P_p, S = (Sw, Sv) the joint's free directions, q' its rates
//   (A B; B^T C)   inertia of all that hangs on P:  f_w = A w + B v,  f_v = B^T w + C v
//   U = I S,  D = S^T U,  lambda the impulse on the axis, (beta, alpha) the relative velocity asked for
//   w = w_p + beta + Sw q',  v = v_p + w_p x r + alpha + Sv q'
// A joint with several free directions is taken as a chain of joints with one, and nothing between them.
// An axis whose drive acts as  q' + k lambda = b  (k its compliance, b its target) has 1/(D + 1/k) in place
// of 1/D: hwparts/joint.h as a part of the tree. k = 0 locks the axis to b.
#pragma once

#include <span>
#include <vector>

#include "server/dynamics/impulse/joint_spec.h"
#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/dynamics/impulse/prediction.h"

namespace visum::dynamics::impulse {

struct TreeNode {
  int body = -1;      // number among the engine's bodies
  int parent = -1;    // node; -1: what stands still, or nothing for a free root
  int joint = -1;     // index of its spec; -1: a free root
  int freedoms = 0;   // of the joint
  double mass = 0.0;  // of the body, kg
};

class Tree {
 public:
  using VectorView = Eigen::Map<const Vector3d>;

  explicit Tree(const Kernels& by = kernels()) : kernels_(&by) {}

  void assign(std::vector<TreeNode> nodes);
  std::size_t size() const { return nodes_.size(); }
  const TreeNode& node(std::size_t i) const { return nodes_[i]; }
  // What hangs together without what stands still; an impulse on one part does nothing to another.
  int part(std::size_t i) const { return part_of_[i]; }

  // From the poses and inertias of `bodies`, the joints' poses and free directions by node, and the axes.
  void factor(const Bodies& bodies, const std::vector<JointPose>& poses, const std::vector<Motion>& free,
              const std::vector<TreeAxis>& axes);

  // What is asked, by node; all zero after clear().
  void clear();
  void clear_part(int part);
  void ask(std::size_t i, const Vector3d& beta, const Vector3d& alpha) {
    TreeAsked& asked = asked_[row_of_[i]];
    Eigen::Map<Vector3d>(asked.beta) = beta;
    Eigen::Map<Vector3d>(asked.alpha) = alpha;
  }
  // Where that is to be written, for kernels, and how far a node's is from there.
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
  void solve_part(int part);  // of what is asked of it; the answers of other parts stay as they are

  // The answer, by node: changes of velocity of the centre of mass, and of the axis of a joint with one.
  VectorView dw(std::size_t i) const { return VectorView(answers_[row_of_[i]].w); }
  VectorView dv(std::size_t i) const { return VectorView(answers_[row_of_[i]].dv); }
  double axis_rate(std::size_t i) const { return answers_[row_of_[i]].rate; }
  // How far a node's are from the first one's.
  long answer(std::size_t i) const {
    return static_cast<long>(row_of_[i] * (sizeof(TreeAnswer) / sizeof(double)));
  }
  const TreeAnswer* answers() const { return answers_.data(); }
  // What an implicit drive has given in this solution, N·m·s.
  double axis_impulse(std::size_t i) const;
  // The largest change of velocity, m/s or rad/s.
  double largest_answer() const;

  // The answer, to the bodies' velocities.
  void apply(Bodies& bodies) const;
  // And what the joints give in it, added to `given` by node; of a free root what is left: rounding.
  void apply_and_note(Bodies& bodies, std::span<JointImpulse> given);

 private:
  struct Root {
    std::size_t row = 0;
    Eigen::Matrix<double, 6, 6> inverse = Eigen::Matrix<double, 6, 6>::Identity();  // of the inertia
  };
  struct Run {
    std::size_t begin = 0, end = 0;
  };
  struct Part {
    std::vector<Run> runs;  // of rows, parents first
    int root = -1;          // index into roots_
  };

  void add_rows(std::size_t node);
  void find_ways();
  void find_parts();
  void factor_root(Root& root);
  void spread_root(const Root& root);
  TreeData data();

  const Kernels* kernels_;
  std::vector<TreeNode> nodes_;
  std::vector<int> part_of_;  // by node
  std::vector<Part> parts_;
  std::vector<Root> roots_;
  std::vector<std::size_t> row_of_;  // by node, that of its body
  std::vector<TreeRow> rows_;        // parents first
  // By row.
  std::vector<TreeFactor> factors_;
  std::vector<TreeAsked> asked_;
  std::vector<TreeAnswer> answers_;
  std::vector<TreeLoad> loads_;
};

}  // namespace visum::dynamics::impulse
