// How far bodies may have gone since they were looked at closely: what is farther apart than two bodies have
// gone together cannot touch. A bound for every point of a body's shapes, from poses alone; the path is
// added up from call to call.
#pragma once

#include <cstddef>
#include <vector>

#include "server/collision/shapes.h"
#include "server/world/world_state.h"

namespace visum::collision {

class Travel {
 public:
  // Of the bodies that the shapes are of.
  Travel(const std::vector<PreparedShape>& shapes, const world::WorldModel& model);

  // To where they are now.
  void follow(const world::WorldState& state);
  // m since restart(). What is not finite is not a number from then on.
  double of(world::BodyId body) const { return moving_[body.index()].path; }
  // How far a body may go until the pairs that are near are to be found again, m: a share of its size.
  double margin(world::BodyId body) const { return moving_[body.index()].margin; }
  bool is_within_margins() const { return within_margins_; }
  void restart();

 private:
  struct Moving {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector4d q = Eigen::Vector4d::Zero();
    double reach = 0.0;  // of its shapes from the centre of mass, m
    double margin = 0.0;
    double path = 0.0;
  };

  std::vector<Moving> moving_;         // by body
  std::vector<std::size_t> followed_;  // bodies with shapes that may move
  bool within_margins_ = false;
};

}  // namespace visum::collision
