#include "server/scene/sensors.h"

#include "protocol/config/unknown_name.h"
#include "server/scene/frames.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;

world::JointId joint_called(const Draft& draft, const Node& node) {
  const auto& world = draft.scene.world;
  const auto found = world.find_joint(node.text());
  if (found.valid()) return found;
  std::vector<std::string> names;
  for (const world::Joint& joint : world.joints) names.push_back(joint.name);
  node.fail(config::unknown_name("joint", node.text(), names));
}

}  // namespace

void read_sensor(Draft& draft, const Node& entry) {
  auto& sensors = draft.scene.sensors;
  if (sensors.size() == kMaxSensors) entry.fail("more than " + std::to_string(kMaxSensors) + " sensors");
  const std::string name = read_name(entry.get("name"));
  draft.claim("part", name, entry.place());
  const std::string kind =
      read_name(entry.get("kind"));  // may throw, so not within the braces (see parts.cc)
  SensorPlan plan{name, kind, entry, {}, {}, {}};
  if (const auto body = entry.find("body")) {
    const LinkFrame link = draft.link(*body);
    plan.body = link.body;
    plan.X_BS = link.X_BL * read_pose_or_identity(entry, "pose");
  } else {
    plan.X_BS = read_world_pose(draft, entry, "pose");
  }
  sensors.push_back(std::move(plan));
}

void find_measured_joints(Draft& draft) {
  for (SensorPlan& plan : draft.scene.sensors)
    if (const auto joint = plan.config.find("joint")) plan.joint = joint_called(draft, *joint);
}

}  // namespace visum::scene
