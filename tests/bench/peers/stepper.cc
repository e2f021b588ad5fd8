#include "tests/bench/peers/stepper.h"

#include <algorithm>

#include "server/world/joint_tree.h"

namespace visum::bench {
namespace {

bool all_hinges(const world::WorldModel& model) {
  return !model.joints.empty() &&
         std::ranges::all_of(model.joints, [](const auto& j) { return j.kind == world::JointKind::kHinge; });
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
           return shape.kind == world::ShapeKind::kBox || shape.kind == world::ShapeKind::kPlane;
         });
}

}  // namespace visum::bench
