#include "server/scene/joints.h"

#include <algorithm>

#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;
using world::JointKind;

constexpr config::Range kLoss{0.0, 1e6};

JointKind read_kind(const Node& node) {
  const std::string word = node.one_of({"hinge", "slider", "fixed"});
  if (word == "hinge") return JointKind::kHinge;
  return word == "slider" ? JointKind::kSlider : JointKind::kFixed;
}

void read_limits(const Node& node, world::Joint& joint) {
  const std::vector<double> limits = node.numbers(2, kPlaceable);
  if (limits[0] > limits[1]) node.fail("the lower limit is above the upper one");
  joint.limited = true;
  joint.lower = limits[0];
  joint.upper = limits[1];
}

void read_position(const Node& node, world::Joint& joint) {
  joint.initial_position = node.number(kPlaceable);
  if (joint.limited && (joint.initial_position < joint.lower || joint.initial_position > joint.upper))
    node.fail("must be within the joint's limits, is " + node.text());
}

void read_freedom(const Node& node, world::Joint& joint) {
  joint.axis_J = read_axis(node.get("axis"));
  if (const auto limits = node.find("limits")) read_limits(*limits, joint);
  joint.friction = node.number_or("friction", 0.0, kLoss);
  joint.damping = node.number_or("damping", 0.0, kLoss);
  joint.stop_restitution = node.number_or("stop_restitution", 0.0, {0.0, 1.0});
  joint.initial_position = nearest_to_zero(joint);
  if (const auto position = node.find("position")) read_position(*position, joint);
}

// `pose` places the joint in the frame of the parent (a link's own frame, in W without a parent). The child
// stays where its own entry puts it.
void place(const Draft& draft, const Node& node, const LinkFrame& parent, const LinkFrame& child,
           world::Joint& joint) {
  const auto& bodies = draft.scene.world.bodies;
  joint.parent = parent.body;
  joint.child = child.body;
  joint.X_PJ = parent.X_BL * read_pose_or_identity(node, "pose");
  const world::Pose X_WP = parent.body.valid() ? bodies[parent.body.index()].X_WB : world::Pose{};
  joint.X_CJ = bodies[child.body.index()].X_WB.inverse() * (X_WP * joint.X_PJ);
}

}  // namespace

double nearest_to_zero(const world::Joint& joint) {
  return joint.limited ? std::clamp(0.0, joint.lower, joint.upper) : 0.0;
}

void read_joint(Draft& draft, const Node& node) {
  node.allow_only({"name", "type", "parent", "child", "pose", "axis", "limits", "friction", "damping",
                   "stop_restitution", "position"});
  world::Joint joint;
  joint.name = read_name(node.get("name"));
  joint.kind = read_kind(node.get("type"));
  const Node child_node = node.get("child");
  const LinkFrame child = draft.link(child_node);
  const auto parent_node = node.find("parent");
  const LinkFrame parent = parent_node ? draft.link(*parent_node) : LinkFrame{};
  if (parent.body == child.body) child_node.fail("is the same body as the parent");
  if (draft.scene.world.bodies[child.body.index()].fixed)
    child_node.fail("must be a body that moves; make the fixed one the parent");
  if (joint.kind != JointKind::kFixed) {
    read_freedom(node, joint);
  } else {
    for (const char* key : {"axis", "limits", "friction", "damping", "stop_restitution", "position"})
      if (const auto other = node.find(key)) other->fail("means nothing for a joint of type fixed");
  }
  place(draft, node, parent, child, joint);
  draft.add_joint(joint, node.place());
}

}  // namespace visum::scene
