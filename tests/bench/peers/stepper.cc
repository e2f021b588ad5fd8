#include "tests/bench/peers/stepper.h"

#include <algorithm>

#include "server/world/joint_kinds.h"
#include "server/world/joint_tree.h"

namespace visum::bench {
namespace {

using world::JointKind;
using world::ShapeKind;

bool all_hinges(const world::WorldModel& model) {
  return !model.joints.empty() &&
         std::ranges::all_of(model.joints, [](const auto& j) { return j.kind == JointKind::kHinge; });
}

bool has_loop(const world::WorldModel& model) {
  const auto carrying = carrying_joints(model);
  const auto trees = std::ranges::count_if(carrying, [](world::JointId id) { return id.valid(); });
  return static_cast<std::size_t>(trees) < model.joints.size();
}

}  // namespace

bool is_open_chain(const world::WorldModel& model) {
  return is_mechanism(model) && !has_loop(model);
}

bool is_mechanism(const world::WorldModel& model) {
  return model.shapes.empty() && all_hinges(model);
}

bool is_boxes_only(const world::WorldModel& model) {
  return model.joints.empty() && std::ranges::all_of(model.shapes, [](const auto& shape) {
           return shape.kind == ShapeKind::kBox || shape.kind == ShapeKind::kPlane;
         });
}

bool is_jointed_scene(const world::WorldModel& model) {
  const auto known = [](const world::Joint& joint) {
    for (const auto kind :
         {JointKind::kHinge, JointKind::kBall, JointKind::kFixed, JointKind::kTorsionSpring})
      if (joint.kind == kind) return true;
    return false;
  };
  const auto simple = [](const world::Shape& shape) {
    for (const auto kind : {ShapeKind::kBox, ShapeKind::kSphere, ShapeKind::kPlane})
      if (shape.kind == kind) return true;
    return false;
  };
  return !model.joints.empty() && !model.shapes.empty() && std::ranges::all_of(model.joints, known) &&
         std::ranges::all_of(model.shapes, simple);
}

bool has_springs(const world::WorldModel& model) {
  return std::ranges::any_of(model.joints,
                             [](const auto& joint) { return !world::info(joint.kind).holds_anything; });
}

}  // namespace visum::bench
