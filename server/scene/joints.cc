#include "server/scene/joints.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/number_text.h"
#include "server/scene/frames.h"
#include "server/scene/values.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

using config::Node;
using world::JointKind;

constexpr config::Range kLoss{0.0, 1e6};
constexpr config::Range kLength{0.0, 1e6};
constexpr config::Range kStiffness{0.0, 1e12};
constexpr double kPerpendicular = 1e-6;
constexpr std::size_t kMaxCurvePoints = 1000;

bool needs_axis(JointKind kind) {
  switch (kind) {
    case JointKind::kFixed:
    case JointKind::kBall:
    case JointKind::kPointOnCurve:
    case JointKind::kSpring:
      return false;
    default:
      return true;
  }
}

// The keys that an entry of this kind may hold besides the keys of all joints.
struct KindKeys {
  JointKind kind;
  std::vector<std::string_view> keys;
};
const std::vector<std::string_view> kDrivable{"axis",    "limits",           "friction",
                                              "damping", "stop_restitution", "position"};
const std::vector<KindKeys> kKindKeys{
    {JointKind::kHinge, kDrivable},
    {JointKind::kSlider, kDrivable},
    {JointKind::kScrew, {"axis", "limits", "friction", "damping", "stop_restitution", "position", "pitch"}},
    {JointKind::kUniversal, {"axis", "axis2"}},
    {JointKind::kCylindrical, {"axis"}},
    {JointKind::kPointOnPlane, {"axis"}},
    {JointKind::kPointOnLine, {"axis"}},
    {JointKind::kPointOnCurve, {"points", "closed"}},
    {JointKind::kSpring, {"child_point", "stiffness", "rest", "damping"}},
    {JointKind::kTorsionSpring, {"axis", "stiffness", "rest", "damping"}},
};

const world::JointKindInfo& read_kind(const Node& node) {
  std::vector<std::string> names;
  for (const auto& kind : world::joint_kinds()) names.push_back(kind.name);
  const std::string word = node.one_of(names);
  return *std::find_if(world::joint_kinds().begin(), world::joint_kinds().end(),
                       [&](const auto& kind) { return kind.name == word; });
}

// Refuses keys that belong to other kinds of joints.
void refuse_foreign_keys(const Node& node, const world::JointKindInfo& kind) {
  const auto own = std::find_if(kKindKeys.begin(), kKindKeys.end(),
                                [&](const KindKeys& keys) { return keys.kind == kind.kind; });
  for (const KindKeys& other : kKindKeys) {
    for (const std::string_view key : other.keys) {
      const bool known =
          own != kKindKeys.end() && std::find(own->keys.begin(), own->keys.end(), key) != own->keys.end();
      if (known) continue;
      if (const auto value = node.find(key))
        value->fail("means nothing for a joint of type " + std::string(kind.name));
    }
  }
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
    node.fail("must be within the joint's limits " + config::number_text(joint.lower) + " and " +
              config::number_text(joint.upper) + ", is " + node.text());
}

void read_freedom(const Node& node, world::Joint& joint) {
  if (const auto limits = node.find("limits")) read_limits(*limits, joint);
  joint.friction = node.number_or("friction", 0.0, kLoss);
  joint.damping = node.number_or("damping", 0.0, kLoss);
  joint.stop_restitution = node.number_or("stop_restitution", 0.0, {0.0, 1.0});
  joint.initial_position = nearest_to_zero(joint);
  if (const auto position = node.find("position")) read_position(*position, joint);
}

void read_spring(const Node& node, world::Joint& joint) {
  joint.stiffness = node.get("stiffness").number(kStiffness);
  joint.damping = node.number_or("damping", 0.0, kLoss);
  joint.rest = node.get("rest").number(joint.kind == JointKind::kSpring ? kLength : kPlaceable);
}

world::Curve read_curve(const Node& node) {
  const Node list = node.get("points");
  const bool closed = node.boolean_or("closed", false);
  if (list.size() > kMaxCurvePoints)
    list.fail("must be at most " + std::to_string(kMaxCurvePoints) + " points");
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < list.size(); ++i) points.push_back(read_vector(list.at(i)));
  world::Curve curve(points, closed);
  if (curve.empty())
    list.fail(closed ? "must be at least 3 points; neighbours must differ, and so must the first and the last"
                     : "must be at least 2 points, neighbours apart");
  return curve;
}

void read_second_axis(const Node& node, world::Joint& joint) {
  const Node second = node.get("axis2");
  joint.axis2_J = read_axis(second);
  if (std::abs(joint.axis_J.dot(joint.axis2_J)) > kPerpendicular)
    second.fail("must be perpendicular to 'axis'");
}

// Reads what the kind of joint needs besides its place.
void read_kind_settings(const Node& node, world::Joint& joint) {
  if (node.find("axis") || needs_axis(joint.kind)) joint.axis_J = read_axis(node.get("axis"));
  if (world::is_drivable(joint.kind)) read_freedom(node, joint);
  if (joint.kind == JointKind::kUniversal) read_second_axis(node, joint);
  if (joint.kind == JointKind::kScrew) joint.pitch_m = node.get("pitch").number(kPlaceable);
  if (joint.kind == JointKind::kPointOnCurve) joint.curve_J = read_curve(node);
  if (!world::info(joint.kind).holds_anything) read_spring(node, joint);
}

// `pose` places the joint in the parent's frame (a link's own frame; W if there is no parent). The child
// stays where its own entry puts it.
void place(const Draft& draft, const Node& node, const LinkFrame& parent, const LinkFrame& child,
           world::Joint& joint) {
  const auto& bodies = draft.scene.world.bodies;
  joint.parent = parent.body;
  joint.child = child.body;
  joint.X_PJ = parent.X_BL * (parent.body.valid() ? read_pose_or_identity(node, "pose")
                                                  : read_world_pose(draft, node, "pose"));
  const world::Pose X_WP = parent.body.valid() ? bodies[parent.body.index()].X_WB : world::Pose{};
  joint.X_CJ = bodies[child.body.index()].X_WB.inverse() * (X_WP * joint.X_PJ);
}

}  // namespace

double nearest_to_zero(const world::Joint& joint) {
  return joint.limited ? std::clamp(0.0, joint.lower, joint.upper) : 0.0;
}

void read_joint(Draft& draft, const Node& node) {
  node.allow_only({"name", "type", "parent", "child", "pose", "axis", "limits", "friction", "damping",
                   "stop_restitution", "position", "axis2", "pitch", "points", "closed", "child_point",
                   "stiffness", "rest"});
  world::Joint joint;
  joint.name = read_name(node.get("name"));
  const world::JointKindInfo& kind = read_kind(node.get("type"));
  joint.kind = kind.kind;
  const Node child_node = node.get("child");
  const LinkFrame child = draft.link(child_node);
  const auto parent_node = node.find("parent");
  const LinkFrame parent = parent_node ? draft.link(*parent_node) : LinkFrame{};
  if (parent.body == child.body) child_node.fail("is the same body as the parent");
  if (draft.scene.world.bodies[child.body.index()].fixed)
    child_node.fail("must be a body that moves; make the fixed one the parent");
  refuse_foreign_keys(node, kind);
  read_kind_settings(node, joint);
  place(draft, node, parent, child, joint);
  if (joint.kind == JointKind::kSpring)
    joint.X_CJ = {child.X_BL * read_vector(node.get("child_point")), child.X_BL.q};
  draft.add_joint(joint, node.place());
}

}  // namespace visum::scene
