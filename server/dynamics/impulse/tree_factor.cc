#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {
namespace {

// [u]x M and [u]x as matrices.
inline Matrix3d cross(const Vector3d& u, const Symmetric3& m) {
  Matrix3d result;
  result << u.y() * m.zx - u.z() * m.xy, u.y() * m.yz - u.z() * m.yy, u.y() * m.zz - u.z() * m.yz,  //
      u.z() * m.xx - u.x() * m.zx, u.z() * m.xy - u.x() * m.yz, u.z() * m.zx - u.x() * m.zz,        //
      u.x() * m.xy - u.y() * m.xx, u.x() * m.yy - u.y() * m.xy, u.x() * m.yz - u.y() * m.zx;
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
      f.axes[k].Sw = free[i].w[k];
      f.axes[k].Sv = free[i].v[k];
    }
    f.turns_only = f.dof == 1 && f.axes[0].Sv.isZero(0.0);
    const double mass = bodies.constants[body].mass;
    const Vector3d lever = mass * f.c;
    const Matrix3d& inertia = bodies.inertia[body];
    const double far = lever.dot(f.c);
    f.A = {inertia(0, 0) + far, inertia(1, 1) + far, inertia(2, 2) + far,
           inertia(0, 1),       inertia(1, 2),       inertia(2, 0)};
    f.A.subtract(lever, f.c);
    f.B = cross_matrix(lever);
    f.C = {mass, mass, mass, 0.0, 0.0, 0.0};
  }
  for (std::size_t i = size(); i-- > 0;) {
    if (root_of_[i] >= 0) {
      Eigen::Matrix<double, 6, 6> inertia;
      inertia << factors_[i].A.full(), factors_[i].B, factors_[i].B.transpose(), factors_[i].C.full();
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
    FreeAxis& to = f.axes[k];
    to.Uw = f.A * to.Sw + f.B * to.Sv;
    to.Uv = f.B.transpose() * to.Sw + f.C * to.Sv;
  }
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t l = 0; l < n; ++l)
      D(static_cast<int>(k), static_cast<int>(l)) =
          f.axes[k].Sw.dot(f.axes[l].Uw) + f.axes[k].Sv.dot(f.axes[l].Uv);
  f.inverse_Ds = D.inverse();
  for (std::size_t k = 0; k < n; ++k) {
    Vector3d gw = Vector3d::Zero(), gv = Vector3d::Zero();
    for (std::size_t l = 0; l < n; ++l) {
      const double g = f.inverse_Ds(static_cast<int>(k), static_cast<int>(l));
      gw += g * f.axes[l].Uw;
      gv += g * f.axes[l].Uv;
    }
    f.A.subtract(f.axes[k].Uw, gw);
    f.B.noalias() -= f.axes[k].Uw * gv.transpose();
    f.C.subtract(f.axes[k].Uv, gv);
  }
}

void Tree::eliminate_one(Factor& f, const TreeAxis& axis) {
  auto& [sw, sv, uw, uv] = f.axes[0];
  uw = f.A * sw;
  uv = f.B.transpose() * sw;
  if (!f.turns_only) {
    uw += f.B * sv;
    uv += f.C * sv;
  }
  f.D = sw.dot(uw) + sv.dot(uv);
  f.implicit = axis.implicit;
  f.inverse_D = axis.implicit ? axis.compliance / (1.0 + axis.compliance * f.D) : 1.0 / f.D;
  f.gain = axis.implicit ? 1.0 / (1.0 + axis.compliance * f.D) : 0.0;
  const Vector3d gw = f.inverse_D * uw, gv = f.inverse_D * uv;
  f.A.subtract(gw, uw);
  f.B.noalias() -= gw * uv.transpose();
  f.C.subtract(gv, uv);
}

// Taken at the parent's point: B' = B + r x C,  A' = A + r x B'^T + (r x B^T)^T,  C' = C.
void Tree::add_to_parent(std::size_t i) {
  if (nodes_[i].parent < 0) return;
  const Factor& f = factors_[i];
  Factor& up = factors_[static_cast<std::size_t>(nodes_[i].parent)];
  const Matrix3d& B = f.B;
  const Matrix3d M = B + cross(f.r, f.C);
  const double x = f.r.x(), y = f.r.y(), z = f.r.z();
  up.A += f.A;
  up.A += {y * (M(0, 2) + B(0, 2)) - z * (M(0, 1) + B(0, 1)),
           z * (M(1, 0) + B(1, 0)) - x * (M(1, 2) + B(1, 2)),
           x * (M(2, 1) + B(2, 1)) - y * (M(2, 0) + B(2, 0)),
           y * M(1, 2) - z * M(1, 1) + z * B(0, 0) - x * B(0, 2),
           z * M(2, 0) - x * M(2, 2) + x * B(1, 1) - y * B(1, 0),
           x * M(0, 1) - y * M(0, 0) + y * B(2, 2) - z * B(2, 1)};
  up.B += M;
  up.C += f.C;
}

}  // namespace visum::dynamics::impulse
