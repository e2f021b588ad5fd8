// How far bodies may have moved since they were looked at closely. Two bodies that were farther apart than
// they have moved together cannot touch. It is a bound for every point of a body's shapes, computed from
// poses alone; the path is added up from call to call.
#pragma once

#include <cstddef>
#include <vector>

#include "server/collision/shapes.h"
#include "server/world/world_state.h"

namespace visum::collision {

// CollisionStage owns it; tick's thread. Nothing fails.
class Travel {
 public:
  // Follows the bodies of these shapes.
  Travel(const std::vector<PreparedShape>& shapes, const world::WorldModel& model);

  // Adds the way from the last poses to the present ones.
  void follow(const world::WorldState& state);
  // Path of a body since restart(), m. It is NaN from then on if a pose was not finite.
  double of(world::BodyId body) const { return moving_[body.index()].path; }
  // How far a body may go before near pairs must be searched again, m: a share of its size.
  double margin(world::BodyId body) const { return moving_[body.index()].margin; }
  bool is_within_margins() const { return within_margins_; }
  // Near pairs have been searched: all paths start at 0.
  void restart();

 private:
  struct Moving {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector4d q = Eigen::Vector4d::Zero();
    double reach = 0.0;  // m, of its shapes from the centre of mass
    double margin = 0.0;
    double path = 0.0;
  };

  std::vector<Moving> moving_;         // by body
  std::vector<std::size_t> followed_;  // bodies whose shapes may move
  bool within_margins_ = false;
};

}  // namespace visum::collision
