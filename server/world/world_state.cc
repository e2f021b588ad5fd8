#include "server/world/world_state.h"

namespace visum::world {

Pose link_pose(const Body& body, const BodyState& state) {
  return {state.p_WC - state.q_WB * body.p_BC, state.q_WB};
}

Eigen::Vector3d link_velocity(const Body& body, const BodyState& state) {
  return state.v_WC - state.w_WB.cross(state.q_WB * body.p_BC);
}

}  // namespace visum::world
