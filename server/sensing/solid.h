// Where a line passes through a convex solid: in double precision, from the solid's own formula, so that a
// ball is a ball. Everything is in the solid's own frame.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "server/world/world_model.h"

namespace visum::sensing {

// The part of the line p + t d that lies inside: in <= t <= out, with the surface's normals there.
// in > out: it misses.
struct Passage {
  double in = -std::numeric_limits<double>::infinity();
  double out = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal_in = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_out = Eigen::Vector3d::Zero();
};

// All x with normal . x <= offset.
struct HalfSpace {
  Eigen::Vector3d normal;  // unit, outwards
  double offset;
};

// What all half-spaces have in common, and, where there is one, a ball or a round bar about z.
struct Solid {
  enum class Round { kNone, kBall, kBar, kCapsule };
  std::vector<HalfSpace> faces;
  Round round = Round::kNone;
  double radius = 0.0;
  double half_length = 0.0;                                                       // capsule: of its axis
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = Eigen::Vector3d::Zero();  // of a box around it
};

// Of every kind but a mesh. The box around a plane is not to be used.
Solid make_solid(const world::WorldModel& model, const world::Shape& shape);

Passage pass_through(const Solid& solid, const Eigen::Vector3d& p, const Eigen::Vector3d& d);

}  // namespace visum::sensing
