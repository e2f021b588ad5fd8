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
// An axis whose drive acts as  q' + k lambda = b  (k its compliance, b its target) has 1/(D + 1/k) in place
// of 1/D: hwparts/joint.h as a part of the tree. k = 0 locks the axis to b.
#pragma once

#include <vector>

#include "server/dynamics/impulse/joint_spec.h"
#include "server/dynamics/impulse/symmetric.h"

namespace visum::dynamics::impulse {

struct TreeNode {
  int body = -1;    // number among the engine's bodies
  int parent = -1;  // node; -1: what stands still, or nothing for a free root
  int joint = -1;   // index of its spec; -1: a free root
};

// How the drive of a node's axis takes part. Only of joints with one axis.
struct TreeAxis {
  bool implicit = false;
  double compliance = 0.0;  // k, (rad/s)/(N·m·s)
};

class Tree {
 public:
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
    asked_[i].beta = beta;
    asked_[i].alpha = alpha;
  }
  void ask_axis(std::size_t i, double target) { asked_[i].target = target; }
  void push_axis(std::size_t i, double impulse) { asked_[i].axis_impulse += impulse; }
  void push_body(std::size_t i, const Vector3d& angular, const Vector3d& linear) {  // at its centre of mass
    asked_[i].angular += angular;
    asked_[i].linear += linear;
  }

  void solve();
  void solve_part(int part);  // of what is asked of it; the answers of other parts stay as they are

  // The answer, by node: changes of velocity of the centre of mass, and of the axis.
  const Vector3d& dw(std::size_t i) const { return answer_[i].w; }
  const Vector3d& dv(std::size_t i) const { return answer_[i].dv; }
  double axis_rate(std::size_t i) const { return answer_[i].rate; }
  // What an implicit drive has given in this solution, N·m·s.
  double axis_impulse(std::size_t i) const;

  const Vector3d& c(std::size_t i) const { return factors_[i].c; }
  const Vector3d& r(std::size_t i) const { return factors_[i].r; }
  const Vector3d& pushed_angular(std::size_t i) const { return asked_[i].angular; }
  const Vector3d& pushed_linear(std::size_t i) const { return asked_[i].linear; }

 private:
  struct FreeAxis {
    Vector3d Sw, Sv, Uw, Uv;
  };
  struct Factor {
    Vector3d r, c;
    int dof = 0;
    bool implicit = false;
    bool turns_only = false;  // one axis, with Sv = 0
    double inverse_D = 0.0;   // of one axis: effective, of what is left free
    double D = 0.0;           // without its drive
    double gain = 0.0;        // share of a drive's target that the axis takes up
    std::array<FreeAxis, 3> axes;
    Symmetric3 A, C;  // what the parent feels: the axes' freedom taken out
    Matrix3d B;
    Matrix3d inverse_Ds;  // of several axes
  };
  struct Asked {
    Vector3d beta = Vector3d::Zero(), alpha = Vector3d::Zero();
    Vector3d angular = Vector3d::Zero(), linear = Vector3d::Zero();
    double target = 0.0, axis_impulse = 0.0;
  };
  struct Answer {
    Vector3d w, v;  // at P
    Vector3d dv;    // of the centre of mass
    double rate = 0.0, axis_load = 0.0;
  };

  void eliminate(Factor& factor, const TreeAxis& axis);
  void eliminate_one(Factor& factor, const TreeAxis& axis);
  void add_to_parent(std::size_t i);
  static double along_axis(const Factor& factor, const Vector3d& pw, const Vector3d& pv);
  void load(std::size_t i);
  void load_up(std::size_t i);
  void spread_down(std::size_t i);
  void spread_root(std::size_t i);
  void spread_joint(std::size_t i);

  std::vector<TreeNode> nodes_;
  std::vector<int> part_of_;
  std::vector<std::vector<std::size_t>> parts_;  // nodes, parents first
  std::vector<Factor> factors_;
  std::vector<Eigen::Matrix<double, 6, 6>>
      roots_;                 // by node that is a free root: inverse inertia, else empty
  std::vector<int> root_of_;  // index into roots_, -1
  std::vector<Asked> asked_;
  std::vector<Vector3d> load_w_, load_v_;         // p
  std::vector<std::array<double, 3>> own_rates_;  // t, the part of q' that the parent does not decide
  std::vector<Answer> answer_;
};

}  // namespace visum::dynamics::impulse
