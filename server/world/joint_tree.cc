#include "server/world/joint_tree.h"

#include "server/world/joint_kinds.h"

namespace visum::world {

std::vector<JointId> carrying_joints(const WorldModel& model) {
  std::vector<JointId> carrying(model.bodies.size());
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    JointId& joint = carrying[model.joints[i].child.index()];
    if (!joint.valid() && carries(model.joints[i].kind)) joint = {static_cast<std::int32_t>(i)};
  }
  return carrying;
}

}  // namespace visum::world
