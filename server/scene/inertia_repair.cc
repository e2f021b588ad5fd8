#include "server/scene/inertia_repair.h"

#include <Eigen/Eigenvalues>

namespace visum::scene {
namespace {

constexpr double kMomentMargin = 1e-9;

}  // namespace

std::optional<Eigen::Matrix3d> as_solid(const Eigen::Matrix3d& inertia) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Vector3d m = solver.eigenvalues();  // ascending
  if (!(m[0] > 1e-9 * m[2])) return std::nullopt;
  const double lack = m[2] * (1.0 + kMomentMargin) - m[0] - m[1];
  m[0] += lack / 2;
  m[1] += lack / 2;
  return solver.eigenvectors() * m.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace visum::scene
