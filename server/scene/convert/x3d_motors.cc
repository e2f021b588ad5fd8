#include "server/scene/convert/x3d_motors.h"

#include <algorithm>
#include <map>

#include "server/scene/convert/x3d_text.h"
#include "server/scene/convert/yaml_text.h"

namespace visum::scene {
namespace {

using config::Node;
using world::JointKind;

bool is_kept(const Scene& scene, const PartPlan& part) {
  if (plugin::find_part(scene.plugins, part.kind)) return false;
  const auto drives = part.context.config.find("drives");
  return drives && drives->kind() == Node::Kind::kScalar &&
         std::ranges::all_of(part.joints, [&](world::JointId id) {
           const JointKind kind = scene.world.joints[id.index()].kind;
           return kind == JointKind::kHinge || kind == JointKind::kSlider;
         });
}

std::string list_of(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) text += (text.empty() ? "" : ", ") + yaml_text(name);
  return "[" + text + "]";
}

// The part's drives, under the joints' new names. Drives of other joints are left out.
std::string drives_text(const Node& file, const std::map<std::string, std::string>& new_names) {
  std::string text = "source: " + yaml_text(file.get("source").text()) + "\ndrives:\n";
  const Node drives = file.get("drives");
  for (std::size_t i = 0; i < drives.size(); ++i) {
    const Node joints = drives.at(i).get("joints");
    std::vector<std::string> renamed;
    for (std::size_t k = 0; k < joints.size(); ++k)
      if (const auto found = new_names.find(joints.at(k).text()); found != new_names.end())
        renamed.push_back(found->second);
    if (!renamed.empty()) text += "  - " + yaml_of(drives.at(i), {{"joints", list_of(renamed)}}) + "\n";
  }
  return text;
}

std::string part_yaml(const Scene& scene, const PartPlan& part, Output& output) {
  std::map<std::string, std::string> new_names;
  std::vector<std::string> joints;
  for (std::size_t i = 0; i < part.joints.size(); ++i) {
    joints.push_back(flat_name(scene.world.joints[part.joints[i].index()].name));
    new_names[part.context.joints[i].name] = joints.back();
  }
  const Node drives = part.context.config.get("drives");
  const Node file = config::load_file(drives.folder() / drives.text());
  const std::string copy = output.add_file(part.context.name + "_drives.yaml", drives_text(file, new_names));
  return yaml_of(part.context.config,
                 {{"model", ""}, {"joints", list_of(joints)}, {"drives", yaml_text(copy)}});
}

// The first hinge of the part without a motor beside it; empty if there is none.
std::string without_motor(const Draft& draft, const Node& part, const std::set<std::string>& motors) {
  const Node joints = part.get("joints");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string name = joints.at(i).text();
    const world::JointId id = draft.scene.world.find_joint(name);
    const bool turns = id.valid() && draft.scene.world.joints[id.index()].kind == JointKind::kHinge;
    if (!id.valid() || (turns && !motors.contains(name))) return name;
  }
  return {};
}

}  // namespace

std::vector<const PartPlan*> parts_with_motors(const Scene& scene, Output& output) {
  std::vector<const PartPlan*> kept;
  for (const PartPlan& part : scene.parts) {
    if (is_kept(scene, part))
      kept.push_back(&part);
    else
      output.lose("X3D has no hardware parts of this kind: '" + part.context.name + "' is left out");
  }
  return kept;
}

std::string motors_yaml(const Scene& scene, const std::vector<const PartPlan*>& parts, Output& output) {
  std::string text;
  for (const PartPlan* part : parts) text += (text.empty() ? "" : ", ") + part_yaml(scene, *part, output);
  return "[" + text + "]";
}

void read_motors(Draft& draft, const Node& parts, const std::set<std::string>& motors) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Node part = parts.at(i);
    if (const std::string joint = without_motor(draft, part, motors); !joint.empty())
      draft.scene.losses.push_back("part '" + part.get("name").text() + "' is not read: the joint '" + joint +
                                   "' has no MotorJoint any more");
    else
      draft.part_entries.push_back(part);
  }
}

}  // namespace visum::scene
