// All that is to be seen of a world (shapes that are not wholly transparent), and rays through it. A surface
// stops a ray from both sides. Embree says which surface a ray meets first; where it does is then computed in
// double precision from that surface, so that the answer does not hang on the processor. Embree stays inside
// ray_world.cc, with its slowest instruction set (SSE2) and one thread: the same on every machine.
//
// place() and cast() on one thread at a time. Nothing of ours allocates there; Embree does inside.
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
  world::BodyId blind_to;  // a body that it passes through: the one that carries the sensor
};

struct Hit {
  world::ShapeId shape;  // invalid: nothing
  double distance_m = 0.0;
  Eigen::Vector3d normal_W = Eigen::Vector3d::Zero();  // unit, against the ray
};

class RayWorld {
 public:
  // Keeps the reference. Throws std::runtime_error where Embree cannot be had.
  explicit RayWorld(const world::WorldModel& model);
  ~RayWorld();
  RayWorld(const RayWorld&) = delete;
  RayWorld& operator=(const RayWorld&) = delete;

  // Where the bodies are from now on; before the first cast().
  void place(const world::WorldState& state);

  Hit cast(const Ray& ray) const;      // the nearest surface
  bool blocked(const Ray& ray) const;  // any surface

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::sensing
