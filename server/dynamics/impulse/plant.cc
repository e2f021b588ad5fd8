#include "server/dynamics/impulse/plant.h"

#include <algorithm>
#include <numeric>

#include "protocol/config/trig.h"
#include "server/world/joint_kinds.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kSameAxis = 1e-9;  // sine of the angle between two axes; m between two lines

// True if the spring acts about or along the very axis of a hinge or slider between the same bodies, so that
// it may be a law of that axis. Finds then what the axis' position says of its length.
bool acts_along(Spring& spring, const Axis& axis) {
  const JointSpec &of = spring.spec, &carrier = *axis.spec;
  if (axis.model->parent != of.model->parent || axis.model->child != of.model->child) return false;
  const Matrix3d R_AB = carrier.frame_a * carrier.frame_b.transpose();  // where the position is 0
  if (of.kind == world::JointKind::kSpring && carrier.kind == world::JointKind::kSlider) {
    const Vector3d reach = carrier.point_a + R_AB * (of.point_b - carrier.point_b) - of.point_a;
    spring.offset = carrier.axis_a.dot(reach);
    return carrier.axis_a.cross(reach).norm() <= kSameAxis;
  }
  if (of.kind != world::JointKind::kTorsionSpring || carrier.kind != world::JointKind::kHinge) return false;
  spring.sense = of.axis_a.dot(carrier.axis_a) > 0.0 ? 1.0 : -1.0;
  const Vector3d &u = of.zero_a, w = R_AB * of.zero_b;
  spring.offset = config::arc_tangent(of.axis_a.dot(u.cross(w)), u.dot(w));
  return of.axis_a.cross(carrier.axis_a).norm() <= kSameAxis &&
         (of.axis_b - spring.sense * carrier.axis_b).norm() <= kSameAxis;
}

// Each spring may be a law of one axis in the tree, and each axis may have one spring. One that is next to
// nothing stays a row: as a law it would give way without limit.
void find_axes_of_springs(std::vector<Spring>& springs, std::vector<Axis>& axes, std::size_t bodies) {
  constexpr double kLeast = 1e-9;                          // N·m/rad, N/m, or that times s
  std::vector<std::size_t> carrying(bodies, Axis::kNone);  // by body: the axis of the joint that carries it
  for (std::size_t k = 0; k < axes.size(); ++k)
    if (axes[k].node >= 0) carrying[static_cast<std::size_t>(axes[k].b)] = k;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const JointSpec& spec = springs[i].spec;
    const std::size_t k = carrying[static_cast<std::size_t>(spec.b)];
    if (std::max(spec.model->stiffness, spec.model->damping) < kLeast || k == Axis::kNone) continue;
    if (axes[k].spring != Axis::kNone || !acts_along(springs[i], axes[k])) continue;
    springs[i].axis = k;
    axes[k].spring = i;
    axes[k].is_free = false;
  }
}

}  // namespace

Plant::Plant(const world::WorldModel& world_model, std::int32_t engine_index)
    : model(world_model),
      setting(world_model.engines[static_cast<std::size_t>(engine_index)]),
      bodies(world_model, engine_index),
      mechanisms(find_mechanisms(world_model, bodies)),
      places(bodies.size()),
      pool(setting.solver == "iterate" ? 1 : setting.threads),
      asleep(bodies.size(), 0),
      mechanism_asleep(mechanisms.size(), 0),
      mechanism_bound(mechanisms.size(), 0) {
  // The iterative solver starts from what is left of the last step, and predicts nothing.
  if (setting.solver != "iterate")
    for (Mechanism& mechanism : mechanisms) mechanism.start_predicting(bodies);
  // By joint: the mechanism and loop that it closes; -1 where it closes none.
  std::vector<std::pair<std::size_t, int>> loops(model.joints.size(), {0, -1});
  for (std::size_t m = 0; m < mechanisms.size(); ++m) {
    for (std::size_t i = 0; i < mechanisms[m].size(); ++i)
      places[static_cast<std::size_t>(mechanisms[m].body(i))] = {static_cast<int>(m), static_cast<int>(i)};
    for (std::size_t i = 0; i < mechanisms[m].loop_count(); ++i)
      loops[mechanisms[m].loop(i).id.index()] = {m, static_cast<int>(i)};
  }
  // Bodies that belong to no mechanism.
  std::vector<int> free;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (places[i].mechanism < 0) free.push_back(static_cast<int>(i));
  free_blocks = bodies.blocks_of(free);
  // Springs and axes, in the order of the joints.
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const world::Joint& joint = model.joints[i];
    const world::JointId id{static_cast<std::int32_t>(i)};
    const int child = bodies.number(joint.child);
    if (child < 0) continue;
    if (!world::info(joint.kind).holds_anything) springs.push_back({make_spec(model, bodies, id)});
    if (!world::is_drivable(joint.kind)) continue;
    Axis axis;
    axis.model = &joint;
    axis.joint = id;
    axis.is_free = joint.friction == 0.0 && joint.damping == 0.0 && !joint.limited;
    if (loops[i].second >= 0) {
      axis.mechanism = loops[i].first;
      axis.loop = loops[i].second;
    } else {
      const Place& place = places[static_cast<std::size_t>(child)];
      axis.mechanism = static_cast<std::size_t>(place.mechanism);
      axis.node = place.node;
    }
    const Mechanism& mechanism = mechanisms[axis.mechanism];
    const auto node = static_cast<std::size_t>(axis.node), loop = static_cast<std::size_t>(axis.loop);
    axis.spec = axis.node >= 0 ? mechanism.carrying(node) : &mechanism.loop(loop);
    axis.pose = axis.node >= 0 ? &mechanism.pose(node) : &mechanism.loop_pose(loop);
    axis.ahead = axis.node >= 0 ? &mechanism.pose_ahead(node) : &mechanism.loop_pose_ahead(loop);
    axis.a = axis.spec->a;
    axis.b = axis.spec->b;
    axis.turns = world::info(joint.kind).is_angle;
    axes.push_back(axis);
  }
  // Axes of one mechanism stand together, within it still in the order of the joints.
  std::stable_sort(axes.begin(), axes.end(),
                   [](const Axis& a, const Axis& b) { return a.mechanism < b.mechanism; });
  first_axis.assign(mechanisms.size() + 1, 0);
  for (const Axis& axis : axes) ++first_axis[axis.mechanism + 1];
  std::partial_sum(first_axis.begin(), first_axis.end(), first_axis.begin());
  // The iterative solver has no tree.
  if (setting.solver != "iterate") find_axes_of_springs(springs, axes, bodies.size());
  acting.reserve(axes.size());
  first_acting.assign(mechanisms.size() + 1, 0);
  islands = Islands(*this);
}

}  // namespace visum::dynamics::impulse
