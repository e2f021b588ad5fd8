// A symmetric matrix by its six numbers.
#pragma once

#include <Eigen/Core>

namespace visum::dynamics::impulse {

struct Symmetric3 {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, yz = 0.0, zx = 0.0;

  Eigen::Vector3d operator*(const Eigen::Vector3d& u) const {
    return {xx * u.x() + xy * u.y() + zx * u.z(), xy * u.x() + yy * u.y() + yz * u.z(),
            zx * u.x() + yz * u.y() + zz * u.z()};
  }
  Symmetric3& operator+=(const Symmetric3& other) {
    xx += other.xx;
    yy += other.yy;
    zz += other.zz;
    xy += other.xy;
    yz += other.yz;
    zx += other.zx;
    return *this;
  }
  // u v^T, of a sum of such products that is symmetric.
  void subtract(const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
    xx -= u.x() * v.x();
    yy -= u.y() * v.y();
    zz -= u.z() * v.z();
    xy -= u.x() * v.y();
    yz -= u.y() * v.z();
    zx -= u.z() * v.x();
  }
  Eigen::Matrix3d full() const {
    Eigen::Matrix3d result;
    result << xx, xy, zx, xy, yy, yz, zx, yz, zz;
    return result;
  }
};

}  // namespace visum::dynamics::impulse
