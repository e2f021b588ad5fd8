// The box of S. Peters' benchmark of rigid bodies (scpeters/benchmark): 0.1 x 0.4 x 0.9 m, 10 kg.
#pragma once

#include <vector>

#include "server/world/world_model.h"

namespace visum::physics {

world::WorldModel tossed_box(const world::EngineSetting& engine, double tick_s, const Eigen::Vector3d& v,
                             const Eigen::Vector3d& w, double g);
// The benchmark's "complex" start, near the unstable axis.
world::WorldModel tumbling_box(const world::EngineSetting& engine, double tick_s);
const Eigen::Matrix3d& tumbled();  // its orientation after 10 s, by DOP853 at 1e-12

struct Toss {
  double momentum = 0.0;  // largest relative change of the angular momentum
  double energy = 0.0;    // relative
  double com_m = 0.0;     // off the parabola, at the end
  Eigen::Matrix3d R;      // at the end
};
// For 10 s, by body.
std::vector<Toss> toss(world::WorldModel model);

double angle_between(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

}  // namespace visum::physics
