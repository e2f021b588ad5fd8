#include "server/scene/frames.h"

#include "server/scene/values.h"

namespace visum::scene {

using config::Node;

void read_frame(Draft& draft, const Node& entry) {
  entry.allow_only({"name", "pose"});
  const std::string name = read_name(entry.get("name"));
  draft.claim("frame", name, entry.place());
  if (draft.frames.size() == kMaxFrames)
    entry.fail("there are more than " + std::to_string(kMaxFrames) + " frames");
  draft.frames.emplace(name, read_world_pose(draft, entry, "pose"));
}

world::Pose read_world_pose(const Draft& draft, const Node& map, std::string_view key) {
  const auto node = map.find(key);
  if (!node) return draft.X_WO.value_or(world::Pose{});
  const world::Pose pose = read_pose_in(*node);
  if (const auto in = node->find("in")) return draft.frame(*in) * pose;
  return draft.X_WO ? *draft.X_WO * pose : pose;
}

Eigen::Vector3d point_in_world(const Draft& draft, const Eigen::Vector3d& point) {
  return draft.X_WO ? *draft.X_WO * point : point;
}

Eigen::Vector3d direction_in_world(const Draft& draft, const Eigen::Vector3d& direction) {
  return draft.X_WO ? draft.X_WO->q * direction : direction;
}

}  // namespace visum::scene
