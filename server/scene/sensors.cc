#include "server/scene/sensors.h"

#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;

world::JointId read_joint_name(const Draft& draft, const Node& node) {
  const auto& world = draft.scene.world;
  const auto found = world.find_joint(node.text());
  if (found.valid()) return found;
  std::vector<std::string> names;
  for (const world::Joint& joint : world.joints) names.push_back(joint.name);
  const auto near = config::nearest(node.text(), names);
  node.fail("there is no joint called '" + node.text() + "'" +
            (near ? "; did you mean '" + *near + "'?" : ""));
}

SensorPlan plan_sensor(Draft& draft, const Node& entry) {
  const std::string name = read_name(entry.get("name"));
  draft.claim("part", name, entry.place());
  SensorPlan plan{name, read_name(entry.get("kind")), entry, {}, read_pose_or_identity(entry, "pose"), {}};
  if (const auto body = entry.find("body")) {
    const LinkFrame link = draft.link(*body);
    plan.body = link.body;
    plan.X_BS = link.X_BL * plan.X_BS;
  }
  if (const auto joint = entry.find("joint")) plan.joint = read_joint_name(draft, *joint);
  return plan;
}

}  // namespace

void plan_sensors(Draft& draft) {
  for (const Node& entry : draft.sensor_entries) {
    if (draft.scene.sensors.size() == kMaxSensors)
      entry.fail("more than " + std::to_string(kMaxSensors) + " sensors");
    draft.scene.sensors.push_back(plan_sensor(draft, entry));
  }
}

}  // namespace visum::scene
