// Changes a robot model after reading: joins links over fixed joints, and matches looks with solids.
#include <algorithm>
#include <map>

#include "server/scene/robot_model.h"

namespace visum::scene {
namespace {

constexpr double kSamePlace = 1e-9;
constexpr double kSheetM = 1e-3;  // thickness of a plane that is only seen

bool same_pose(const world::Pose& a, const world::Pose& b) {
  return (a.p - b.p).norm() < kSamePlace && a.q.angularDistance(b.q) < kSamePlace;
}

bool same_form(const RobotShape& a, const RobotShape& b) {
  const bool same_size = a.size == b.size || a.kind == world::ShapeKind::kPlane;
  return a.kind == b.kind && same_size && a.mesh == b.mesh && a.scale == b.scale && same_pose(a.X_LS, b.X_LS);
}

// A colliding plane is infinite; a visible one has sides. So it becomes a thin box below its face.
RobotShape as_sheet(RobotShape visual) {
  if (visual.kind != world::ShapeKind::kPlane) return visual;
  visual.kind = world::ShapeKind::kBox;
  visual.size[2] = kSheetM;
  visual.X_LS = visual.X_LS * world::Pose{{0, 0, -kSheetM / 2}, Eigen::Quaterniond::Identity()};
  return visual;
}

// Moves all of `lower` into `upper`; X_UL is the pose of `lower` in it.
void absorb(RobotLink& upper, const RobotLink& lower, const world::Pose& X_UL) {
  upper.self_collides = upper.self_collides || lower.self_collides;
  upper.mass = together(upper.mass, moved(lower.mass, X_UL));
  for (RobotShape shape : lower.shapes) {
    shape.X_LS = X_UL * shape.X_LS;
    upper.shapes.push_back(std::move(shape));
  }
}

// Lets joints and joined links that named `joint.child` name its parent instead.
void reattach(RobotModel& model, const RobotJoint& joint, const world::Pose& X_UL) {
  for (RobotJoint& other : model.joints) {
    if (other.parent == joint.child) {
      other.parent = joint.parent;
      other.joint.X_PJ = X_UL * other.joint.X_PJ;
    }
    if (other.child == joint.child) {
      other.child = joint.parent;
      other.joint.X_CJ = X_UL * other.joint.X_CJ;
    }
  }
  for (JoinedLink& joined : model.joined) {
    if (joined.into != joint.child) continue;
    joined.into = joint.parent;
    joined.X_IL = X_UL * joined.X_IL;
  }
  model.joined.push_back({joint.child, joint.parent, X_UL});
}

RobotLink& find_link(RobotModel& model, const std::string& name) {
  return *std::find_if(model.links.begin(), model.links.end(),
                       [&](const RobotLink& l) { return l.name == name; });
}

// Joins the child of a fixed joint into its parent; a child of the world is fixed there instead.
void join(RobotModel& model, const RobotJoint& joint) {
  if (joint.parent == kWorldLink) {
    find_link(model, joint.child).on_ground = true;
    return;
  }
  const world::Pose X_UL = joint.joint.X_PJ * joint.joint.X_CJ.inverse();
  const RobotLink lower = find_link(model, joint.child);
  RobotLink& upper = find_link(model, joint.parent);
  absorb(upper, lower, X_UL);
  upper.on_ground = upper.on_ground || lower.on_ground;
  model.links.erase(std::find_if(model.links.begin(), model.links.end(),
                                 [&](const RobotLink& l) { return l.name == lower.name; }));
  reattach(model, joint, X_UL);
}

// One note for each link that others were joined into.
void note_joined(RobotModel& model) {
  std::map<std::string, std::string> lists;
  for (const JoinedLink& joined : model.joined)
    lists[joined.into] += (lists[joined.into].empty() ? "'" : ", '") + joined.name + "'";
  for (const auto& [into, names] : lists)
    model.notes.push_back("fixed joints join " + names + " into link '" + into + "': one body of that name");
}

}  // namespace

void match_visuals(RobotLink& link) {
  const bool has_visuals =
      std::any_of(link.shapes.begin(), link.shapes.end(), [](const RobotShape& s) { return !s.collides; });
  if (!has_visuals) return;
  std::vector<RobotShape> kept;
  for (const RobotShape& shape : link.shapes) {
    if (!shape.collides) continue;
    kept.push_back(shape);
    kept.back().color = {0.0, 0.0, 0.0, 0.0};
  }
  for (RobotShape& visual : link.shapes) {
    if (visual.collides) continue;
    const auto twin = std::find_if(kept.begin(), kept.end(),
                                   [&](const RobotShape& s) { return s.collides && same_form(s, visual); });
    if (twin == kept.end())
      kept.push_back(as_sheet(std::move(visual)));
    else
      twin->color = visual.color.value_or(world::Shape{}.color);
  }
  link.shapes = std::move(kept);
}

void join_links(RobotModel& model) {
  const auto is_fixed = [](const RobotJoint& j) {
    return j.joint.kind == world::JointKind::kFixed && !j.closes_loop;
  };
  for (auto found = std::find_if(model.joints.begin(), model.joints.end(), is_fixed);
       found != model.joints.end();
       found = std::find_if(model.joints.begin(), model.joints.end(), is_fixed)) {
    const RobotJoint joint = *found;
    model.joints.erase(found);
    // A second fixed joint between links that are already one adds nothing.
    if (joint.parent != joint.child) join(model, joint);
  }
  note_joined(model);
}

std::vector<std::string> models_of_world(const RobotModel& world) {
  std::vector<std::string> names;
  for (const RobotLink& link : world.links) {
    const std::string model = link.name.substr(0, link.name.find("::"));
    if (std::find(names.begin(), names.end(), model) == names.end()) names.push_back(model);
  }
  return names;
}

RobotModel one_of_world(const RobotModel& world, const std::string& model) {
  const std::string prefix = model + "::";
  const auto strip = [&](std::string& name) {
    const bool inside = name.compare(0, prefix.size(), prefix) == 0;
    if (inside) name = name.substr(prefix.size());
    return inside;
  };
  RobotModel one;
  one.file = world.file;
  one.world = world.world;
  for (RobotLink link : world.links) {
    if (!strip(link.name)) continue;
    for (RobotShape& shape : link.shapes) {
      strip(shape.link);
      if (const auto mesh = world.converted.find(shape.mesh); mesh != world.converted.end())
        one.converted.insert(*mesh);
      else if (const auto seen = world.seen.find(shape.mesh); seen != world.seen.end())
        one.seen.insert(*seen);
    }
    one.links.push_back(std::move(link));
  }
  for (RobotJoint joint : world.joints) {
    if (!strip(joint.joint.name)) continue;
    strip(joint.parent);
    strip(joint.child);
    if (joint.mimic) strip(joint.mimic->leader);
    one.joints.push_back(std::move(joint));
  }
  for (JoinedLink joined : world.joined)
    if (strip(joined.name) && strip(joined.into)) one.joined.push_back(std::move(joined));
  return one;
}

}  // namespace visum::scene
