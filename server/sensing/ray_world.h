// Casts rays through the visible shapes of a world: those that are not wholly transparent. A surface stops a
// ray from both sides.
//
// Embree finds the surface that a ray meets first. Where exactly the ray meets it is then computed in double
// precision from that surface, so that the answer does not depend on the processor. Embree stays inside
// ray_world.cc and embree.cc, which loads it. It uses one thread and its slowest instruction set (SSE2),
// which is the same on every machine.
//
// place(), cast() and blocked() must be called by one thread at a time. Nothing of ours allocates there;
// Embree does inside.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::sensing {

struct Ray {
  Eigen::Vector3d p_W;
  Eigen::Vector3d direction_W;  // unit
  double length_m = 0.0;
  world::BodyId blind_to;  // the ray passes through this body: the one that carries the sensor
};

struct Hit {
  world::ShapeId shape;  // invalid: nothing
  double distance_m = 0.0;
  Eigen::Vector3d normal_W = Eigen::Vector3d::Zero();  // unit, against the ray
};

class RayWorld {
 public:
  // Keeps the reference. Throws std::runtime_error where Embree is not there or does not start.
  explicit RayWorld(const world::WorldModel& model);
  ~RayWorld();
  RayWorld(const RayWorld&) = delete;
  RayWorld& operator=(const RayWorld&) = delete;

  // Moves the shapes to where this state has their bodies. Needed once before the first cast().
  void place(const world::WorldState& state);

  Hit cast(const Ray& ray) const;      // the nearest surface
  bool blocked(const Ray& ray) const;  // whether there is any surface within the ray's length

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::sensing
