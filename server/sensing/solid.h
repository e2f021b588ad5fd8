// Computes where a line passes through a convex solid, in double precision and from the solid's own formula:
// a ball stays round, however near one looks. Everything is in the solid's own frame. Pure functions.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "server/world/world_model.h"

namespace visum::sensing {

// The part of the line p + t d that lies inside the solid: in <= t <= out, with the surface's normals at both
// ends. Where in > out, the line misses the solid.
struct Passage {
  double in = -std::numeric_limits<double>::infinity();
  double out = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal_in = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_out = Eigen::Vector3d::Zero();
};

// All points x with normal . x <= offset.
struct HalfSpace {
  Eigen::Vector3d normal;  // unit, outwards
  double offset;
};

// The intersection of its half-spaces with a ball, an endless round bar about z, or a capsule, if `round`
// says so.
struct Solid {
  enum class Round { kNone, kBall, kBar, kCapsule };
  std::vector<HalfSpace> faces;
  Round round = Round::kNone;
  double radius = 0.0;
  double half_length = 0.0;                                                       // capsule: of its axis
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  // of a box around it
};

// For shapes of every kind but a mesh. The solid of a plane has no box: it is endless.
Solid make_solid(const world::WorldModel& model, const world::Shape& shape);

Passage pass_through(const Solid& solid, const Eigen::Vector3d& p, const Eigen::Vector3d& d);

}  // namespace visum::sensing
