// An open chain of pins in Simbody, behind plain values. Simbody's headers are C++17 at most and ours are
// C++20; this header is both.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

namespace visum::bench {

struct Pin {
  int parent;               // -1: ground
  Eigen::Vector3d p_joint;  // in the parent's frame
  Eigen::Vector3d axis;
  double mass_kg;
  Eigen::Vector3d p_com;    // from the joint
  Eigen::Matrix3d inertia;  // about the centre of mass
  double q0;
};

struct PinMotion {  // of the centre of mass, in ground
  Eigen::Vector3d p, v, w;
  Eigen::Quaterniond q;
};

class SimbodyChain {
 public:
  SimbodyChain(const Eigen::Vector3d& gravity, double tick_s, const std::vector<Pin>& pins);
  ~SimbodyChain();
  void reset();
  void step();
  std::vector<PinMotion> motions() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::bench
