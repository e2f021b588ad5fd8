#include "server/collision/travel.h"

#include <algorithm>
#include <limits>

namespace visum::collision {
namespace {

constexpr double kMarginShare = 0.2;  // of a body's reach
constexpr double kLeastMarginM = 1e-3, kMostMarginM = 0.05;

// Largest distance of the shape's box from the body's centre of mass, m.
double reach_of(const PreparedShape& shape, const Eigen::Vector3d& p_BC) {
  double reach = 0.0;
  for (int i = 0; i < 8; ++i) {
    const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(i);
    reach = std::max(reach, (shape.X_BS * shape.box_S.corner(corner) - p_BC).norm());
  }
  return reach;
}

}  // namespace

Travel::Travel(const std::vector<PreparedShape>& shapes, const world::WorldModel& model)
    : moving_(model.bodies.size()) {
  for (const PreparedShape& shape : shapes) {
    if (shape.fixed || shape.box_S.isEmpty()) continue;
    Moving& moving = moving_[shape.body.index()];
    moving.reach = std::max(moving.reach, reach_of(shape, model.bodies[shape.body.index()].p_BC));
    followed_.push_back(shape.body.index());
  }
  std::sort(followed_.begin(), followed_.end());
  followed_.erase(std::unique(followed_.begin(), followed_.end()), followed_.end());
  for (const std::size_t body : followed_) {
    Moving& moving = moving_[body];
    moving.margin = std::clamp(kMarginShare * moving.reach, kLeastMarginM, kMostMarginM);
    moving.path = std::numeric_limits<double>::infinity();  // infinite: nothing has been looked at yet
  }
}

// A rotation by the angle a moves a point at r from the centre of mass by at most 2 r |sin(a/2)|. |sin(a/2)|
// is at most the distance of the two quaternions.
void Travel::follow(const world::WorldState& state) {
  within_margins_ = true;
  for (const std::size_t body : followed_) {
    Moving& moving = moving_[body];
    const world::BodyState& now = state.bodies[body];
    moving.path += (now.p_WC - moving.p).norm() + 2.0 * moving.reach * (now.q_WB.coeffs() - moving.q).norm();
    moving.p = now.p_WC;
    moving.q = now.q_WB.coeffs();
    within_margins_ = within_margins_ && moving.path <= moving.margin;
  }
}

void Travel::restart() {
  for (const std::size_t body : followed_) moving_[body].path = 0.0;
  within_margins_ = true;
}

}  // namespace visum::collision
