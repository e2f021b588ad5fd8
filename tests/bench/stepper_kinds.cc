#include <algorithm>

#include "server/world/joint_tree.h"
#include "tests/bench/our_stepper.h"
#include "tests/bench/peers/peers.h"
#include "tests/bench/stepper.h"
#include "tests/dynamics/physics/engine_rows.h"

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

std::vector<StepperKind> all_kinds() {
  std::vector<StepperKind> kinds;
  for (const auto& row : physics::engine_rows()) kinds.push_back({row.name, can_be_made, make_our_stepper});
#ifdef VISUM_PEER_ODE
  add_bare_ode(kinds);
#endif
#ifdef VISUM_PEER_MUJOCO
  add_mujoco(kinds);
#endif
#ifdef VISUM_PEER_BULLET
  add_bullet(kinds);
#endif
#ifdef VISUM_PEER_DART
  add_dart(kinds);
#endif
#ifdef VISUM_PEER_SIMBODY
  add_simbody(kinds);
#endif
#ifdef VISUM_PEER_KDL
  add_kdl(kinds);
#endif
  return kinds;
}

}  // namespace

const std::vector<StepperKind>& stepper_kinds() {
  static const std::vector<StepperKind> kinds = all_kinds();
  return kinds;
}

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
