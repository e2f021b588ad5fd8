#include "server/scene/parts.h"

#include <algorithm>
#include <map>
#include <set>

#include "protocol/config/unknown_name.h"
#include "server/scene/values.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

using config::Node;
using world::JointId;

using JointsByName = std::map<std::string, JointId>;

// The drivable joints that an entry may name, by the names that it uses: those of its model without the
// model's name, or all joints of the world.
JointsByName offered_joints(const Draft& draft, const std::string& prefix) {
  JointsByName offered;
  const auto& joints = draft.scene.world.joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!world::is_drivable(joints[i].kind) || joints[i].name.compare(0, prefix.size(), prefix) != 0)
      continue;
    offered.emplace(joints[i].name.substr(prefix.size()), JointId{static_cast<std::int32_t>(i)});
  }
  return offered;
}

JointId pick(const JointsByName& offered, const Node& node) {
  const auto found = offered.find(node.text());
  if (found != offered.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [name, id] : offered) names.push_back(name);
  node.fail(config::unknown_name("movable joint", node.text(), names));
}

std::string model_prefix(const Draft& draft, const Node& entry) {
  const auto model = entry.find("model");
  if (!model) return "";
  std::vector<std::string> known;
  for (const world::Body& body : draft.scene.world.bodies)
    if (!body.model.empty() && (known.empty() || known.back() != body.model)) known.push_back(body.model);
  if (std::find(known.begin(), known.end(), model->text()) == known.end())
    model->fail(config::unknown_name("model", model->text(), known));
  return model->text() + "/";
}

// The joints of an entry, in the order of the world, which is the model's order. Joints that follow others
// are among them only if the entry names them.
std::vector<JointId> joints_of(const Draft& draft, const Node& entry, const std::string& prefix) {
  const JointsByName offered = offered_joints(draft, prefix);
  std::set<JointId> joints;
  if (const auto list = entry.find("joints")) {
    for (std::size_t i = 0; i < list->size(); ++i)
      if (!joints.insert(pick(offered, list->at(i))).second) list->at(i).fail("is named twice");
  } else if (!prefix.empty()) {
    for (const auto& [name, id] : offered)
      if (!draft.followers.contains(prefix + name)) joints.insert(id);
  }
  return {joints.begin(), joints.end()};
}

// The inertia of the joint's child alone.
double inertia_about(const world::Joint& joint, const world::Body& link) {
  const Eigen::Vector3d axis = joint.X_CJ.q * joint.axis_J;
  const Eigen::Vector3d lever = axis.cross(link.p_BC - joint.X_CJ.p);
  return axis.dot(link.inertia_C * axis) + link.mass_kg * lever.squaredNorm();
}

hwparts::JointInfo describe(const Draft& draft, const world::Joint& joint, const std::string& prefix) {
  hwparts::JointInfo info;
  info.name = joint.name.substr(prefix.size());
  info.prismatic = joint.kind == world::JointKind::kSlider;
  info.lower = joint.limited ? joint.lower : 1.0;  // lower > upper: no stops
  info.upper = joint.limited ? joint.upper : -1.0;
  info.initial_position = joint.initial_position;
  const world::Body& link = draft.scene.world.bodies[joint.child.index()];
  info.moves_by_mean_speed = draft.is_impulse(link.engine);
  info.inertia = info.prismatic ? link.mass_kg : inertia_about(joint, link);
  if (const auto limit = draft.drive_limits.find(joint.name); limit != draft.drive_limits.end()) {
    info.maximum_speed = limit->second.speed;
    info.maximum_effort = limit->second.effort;
  }
  return info;
}

void plan_part(Draft& draft, const Node& entry, std::map<JointId, std::string>& drivers) {
  const auto& world = draft.scene.world;
  const std::string name = read_name(entry.get("name"));
  draft.claim("part", name, entry.place());
  const std::string prefix = model_prefix(draft, entry);
  // Calls that may throw come first: GCC 12 destroys members twice if a later one throws within the braces.
  const std::string kind = read_name(entry.get("kind"));
  const std::vector<JointId> joints = joints_of(draft, entry, prefix);
  PartPlan plan{kind, {name, entry, {}, static_cast<double>(world.tick_ns) * 1e-9}, joints};
  for (const JointId id : plan.joints) {
    const world::Joint& joint = world.joints[id.index()];
    if (world.bodies[joint.child.index()].kinematic)
      entry.fail("joint '" + joint.name + "' is of a kinematic model: no part drives it");
    const auto [driver, is_free] = drivers.emplace(id, name);
    if (draft.is_spawned && draft.is_old(id))
      entry.fail("joint '" + joint.name +
                 "' was there before: a model that is spawned drives its own joints");
    if (!is_free) entry.fail("joint '" + joint.name + "' is driven by part '" + driver->second + "' already");
    plan.context.joints.push_back(describe(draft, joint, prefix));
  }
  draft.scene.parts.push_back(std::move(plan));
}

// Joints follow unless a part drives them.
void plan_followers(Draft& draft, const std::map<JointId, std::string>& drivers) {
  const world::WorldModel& world = draft.scene.world;
  for (const auto& [name, follower] : draft.followers) {
    const JointId id = world.find_joint(name);
    const auto driver = drivers.find(id);
    if (driver != drivers.end()) {
      draft.scene.notes.push_back("joint '" + name + "' does not follow '" + follower.leader + "': part '" +
                                  driver->second + "' drives it");
      continue;
    }
    const Draft::DriveLimit limit = draft.drive_limits[name];
    draft.scene.followers.push_back({id, world.find_joint(follower.leader), follower.multiplier,
                                     follower.offset, limit.speed, limit.effort});
  }
}

}  // namespace

void plan_parts(Draft& draft) {
  std::map<JointId, std::string> drivers;
  for (const Node& entry : draft.part_entries) plan_part(draft, entry, drivers);
  plan_followers(draft, drivers);
}

}  // namespace visum::scene
