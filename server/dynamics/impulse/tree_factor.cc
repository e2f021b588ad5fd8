#include <Eigen/LU>

#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {
namespace {

// A matrix from its cyclic diagonals (tree_data.h).
Matrix3d full_matrix(const double* d0, const double* d1, const double* d2) {
  Matrix3d result;
  result << d0[0], d1[0], d2[0], d2[1], d0[1], d1[1], d1[2], d2[2], d0[2];
  return result;
}

Matrix3d full_symmetric(const double (&m)[2][4]) {
  const double* off = m[1];
  const double other[3] = {off[2], off[0], off[1]};
  return full_matrix(m[0], off, other);
}

}  // namespace

void Tree::factor(const Bodies& bodies, const std::vector<JointPose>& poses, const std::vector<Motion>& free,
                  const std::vector<TreeAxis>& axes) {
  static_assert(sizeof(Vector3d) == 3 * sizeof(double) && sizeof(Matrix3d) == 9 * sizeof(double));
  static_assert(sizeof(JointPose) % sizeof(double) == 0 && sizeof(Motion) % sizeof(double) == 0);
  if (rows_.empty()) return;
  const TreePlace place{.x = bodies.x[0].data(),
                        .inertia = bodies.inertia[0].data(),
                        .points = poses[0].pb.data(),
                        .free_w = free[0].w[0].data(),
                        .free_v = free[0].v[0].data(),
                        .point_stride = sizeof(JointPose) / sizeof(double),
                        .free_stride = sizeof(Motion) / sizeof(double),
                        .axes = axes.data()};
  kernels_->factor_tree(rows_.data(), factors_.data(), place, rows_.size());
  for (Root& root : roots_) factor_root(root);
}

// By blocks of 3 x 3: C is the mass of all that hangs there, A - B C^-1 B^T its inertia about its centre.
void Tree::factor_root(Root& root) {
  const TreeFactor& f = factors_[root.row];
  const Matrix3d B = full_matrix(f.B[0], f.B[1], f.B[2]);
  const Matrix3d inverse_C = full_symmetric(f.C).inverse(), lever = B * inverse_C;
  const Matrix3d turning = (full_symmetric(f.A) - lever * B.transpose()).inverse();
  const Matrix3d coupling = -turning * lever;
  root.inverse << turning, coupling, coupling.transpose(), inverse_C - lever.transpose() * coupling;
}

}  // namespace visum::dynamics::impulse
