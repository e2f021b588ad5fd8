#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {
namespace {

// [u]x M and [u]x as matrices.
inline Matrix3d cross(const Vector3d& u, const Matrix3d& m) {
  Matrix3d result;
  for (int i = 0; i < 3; ++i) {
    result(0, i) = u.y() * m(2, i) - u.z() * m(1, i);
    result(1, i) = u.z() * m(0, i) - u.x() * m(2, i);
    result(2, i) = u.x() * m(1, i) - u.y() * m(0, i);
  }
  return result;
}

Matrix3d cross_matrix(const Vector3d& u) {
  Matrix3d result;
  result << 0.0, -u.z(), u.y(), u.z(), 0.0, -u.x(), -u.y(), u.x(), 0.0;
  return result;
}

}  // namespace

void Tree::assign(std::vector<TreeNode> nodes) {
  nodes_ = std::move(nodes);
  part_of_.resize(nodes_.size());
  parts_.clear();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const int parent = nodes_[i].parent;
    if (parent < 0) parts_.emplace_back();
    part_of_[i] =
        parent < 0 ? static_cast<int>(parts_.size()) - 1 : part_of_[static_cast<std::size_t>(parent)];
    parts_[static_cast<std::size_t>(part_of_[i])].push_back(i);
  }
  factors_.resize(nodes_.size());
  asked_.resize(nodes_.size());
  answer_.resize(nodes_.size());
  load_w_.resize(nodes_.size());
  load_v_.resize(nodes_.size());
  own_rates_.resize(nodes_.size());
  root_of_.assign(nodes_.size(), -1);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].joint >= 0) continue;
    root_of_[i] = static_cast<int>(roots_.size());
    roots_.emplace_back();
  }
}

void Tree::factor(const Bodies& bodies, const std::vector<JointPose>& poses, const std::vector<Motion>& free,
                  const std::vector<TreeAxis>& axes) {
  for (std::size_t i = 0; i < size(); ++i) {
    const TreeNode& node = nodes_[i];
    const auto body = static_cast<std::size_t>(node.body);
    Factor& f = factors_[i];
    const bool root = node.joint < 0;
    const Vector3d& p = root ? bodies.x[body] : poses[i].pb;
    f.c = bodies.x[body] - p;
    if (node.parent >= 0) {
      const auto up = static_cast<std::size_t>(node.parent);
      f.r = p - (nodes_[up].joint < 0 ? bodies.x[static_cast<std::size_t>(nodes_[up].body)] : poses[up].pb);
    } else {
      f.r.setZero();
    }
    f.dof = root ? 6 : free[i].count;
    for (std::size_t k = 0; k < static_cast<std::size_t>(root ? 0 : f.dof); ++k) {
      f.Sw[k] = free[i].w[k];
      f.Sv[k] = free[i].v[k];
    }
    const double mass = bodies.constants[body].mass;
    f.A = bodies.inertia[body] - mass * f.c * f.c.transpose();
    f.A.diagonal().array() += mass * f.c.squaredNorm();
    f.B = cross_matrix(mass * f.c);
    f.C = mass * Matrix3d::Identity();
  }
  for (std::size_t i = size(); i-- > 0;) {
    if (root_of_[i] >= 0) {
      Eigen::Matrix<double, 6, 6> inertia;
      inertia << factors_[i].A, factors_[i].B, factors_[i].B.transpose(), factors_[i].C;
      roots_[static_cast<std::size_t>(root_of_[i])] =
          inertia.llt().solve(Eigen::Matrix<double, 6, 6>::Identity());
      continue;
    }
    eliminate(factors_[i], axes[i]);
    add_to_parent(i);
  }
}

// I <- I - U D^-1 U^T.
void Tree::eliminate(Factor& f, const TreeAxis& axis) {
  f.implicit = false;
  if (f.dof == 1) return eliminate_one(f, axis);
  const auto n = static_cast<std::size_t>(f.dof);
  Matrix3d D = Matrix3d::Identity();
  for (std::size_t k = 0; k < n; ++k) {
    f.Uw[k] = f.A * f.Sw[k] + f.B * f.Sv[k];
    f.Uv[k] = f.B.transpose() * f.Sw[k] + f.C * f.Sv[k];
  }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t l = 0; l < n; ++l)
      D(static_cast<int>(k), static_cast<int>(l)) = f.Sw[k].dot(f.Uw[l]) + f.Sv[k].dot(f.Uv[l]);
  f.inverse_D = D.inverse();
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t l = 0; l < n; ++l) {
      const double g = f.inverse_D(static_cast<int>(k), static_cast<int>(l));
      f.A.noalias() -= g * f.Uw[k] * f.Uw[l].transpose();
      f.B.noalias() -= g * f.Uw[k] * f.Uv[l].transpose();
      f.C.noalias() -= g * f.Uv[k] * f.Uv[l].transpose();
    }
  }
}

void Tree::eliminate_one(Factor& f, const TreeAxis& axis) {
  const Vector3d &sw = f.Sw[0], &sv = f.Sv[0];
  Vector3d &uw = f.Uw[0], &uv = f.Uv[0];
  uw = f.A * sw + f.B * sv;
  uv = f.B.transpose() * sw + f.C * sv;
  f.D = sw.dot(uw) + sv.dot(uv);
  f.implicit = axis.implicit;
  const double g = axis.implicit ? axis.compliance / (1.0 + axis.compliance * f.D) : 1.0 / f.D;
  f.gain = axis.implicit ? 1.0 / (1.0 + axis.compliance * f.D) : 0.0;
  f.inverse_D(0, 0) = g;
  const Vector3d gw = g * uw, gv = g * uv;
  f.A.noalias() -= gw * uw.transpose();
  f.B.noalias() -= gw * uv.transpose();
  f.C.noalias() -= gv * uv.transpose();
}

// Taken at the parent's point: A + r x B^T + (r x B^T)^T - r x C r x,  B + r x C,  C.
void Tree::add_to_parent(std::size_t i) {
  if (nodes_[i].parent < 0) return;
  const Factor& f = factors_[i];
  Factor& up = factors_[static_cast<std::size_t>(nodes_[i].parent)];
  const Matrix3d rC = cross(f.r, f.C);
  const Matrix3d rBt = cross(f.r, f.B.transpose());
  // -r x C r x = (r x (r x C)^T)^T, and C is symmetric.
  up.A += f.A + rBt + rBt.transpose() + cross(f.r, rC.transpose());
  up.B += f.B + rC;
  up.C += f.C;
}

}  // namespace visum::dynamics::impulse
