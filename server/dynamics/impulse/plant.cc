#include "server/dynamics/impulse/plant.h"

#include <algorithm>
#include <numeric>

#include "server/world/joint_kinds.h"

namespace visum::dynamics::impulse {

Plant::Plant(const world::WorldModel& world_model, std::int32_t engine_index)
    : model(world_model),
      setting(world_model.engines[static_cast<std::size_t>(engine_index)]),
      bodies(world_model, engine_index),
      mechanisms(find_mechanisms(world_model, bodies)),
      places(bodies.size()),
      asleep(bodies.size(), 0),
      mechanism_asleep(mechanisms.size(), 0) {
  if (setting.solver != "iterate")
    for (Mechanism& mechanism : mechanisms) mechanism.start_predicting();
  std::vector<std::pair<std::size_t, int>> loops(model.joints.size(), {0, -1});
  for (std::size_t m = 0; m < mechanisms.size(); ++m) {
    for (std::size_t i = 0; i < mechanisms[m].size(); ++i)
      places[static_cast<std::size_t>(mechanisms[m].body(i))] = {static_cast<int>(m), static_cast<int>(i)};
    for (std::size_t i = 0; i < mechanisms[m].loop_count(); ++i)
      loops[mechanisms[m].loop(i).id.index()] = {m, static_cast<int>(i)};
  }
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
    if (loops[i].second >= 0) {
      axis.mechanism = loops[i].first;
      axis.loop = loops[i].second;
    } else {
      const Place& place = places[static_cast<std::size_t>(child)];
      axis.mechanism = static_cast<std::size_t>(place.mechanism);
      axis.node = place.node;
    }
    axes.push_back(axis);
  }
  std::stable_sort(axes.begin(), axes.end(),
                   [](const Axis& a, const Axis& b) { return a.mechanism < b.mechanism; });
  first_axis.assign(mechanisms.size() + 1, 0);
  for (const Axis& axis : axes) ++first_axis[axis.mechanism + 1];
  std::partial_sum(first_axis.begin(), first_axis.end(), first_axis.begin());
}

const JointSpec& Plant::spec(const Axis& axis) const {
  const Mechanism& mechanism = mechanisms[axis.mechanism];
  return axis.node >= 0 ? *mechanism.carrying(static_cast<std::size_t>(axis.node))
                        : mechanism.loop(static_cast<std::size_t>(axis.loop));
}

const JointPose& Plant::pose_ahead(const Axis& axis) const {
  const Mechanism& mechanism = mechanisms[axis.mechanism];
  return axis.node >= 0 ? mechanism.pose_ahead(static_cast<std::size_t>(axis.node))
                        : mechanism.loop_pose_ahead(static_cast<std::size_t>(axis.loop));
}

double Plant::rate(const Axis& axis) const {
  const JointSpec& joint = spec(axis);
  const Mechanism& mechanism = mechanisms[axis.mechanism];
  const JointPose& pose = axis.node >= 0 ? mechanism.pose(static_cast<std::size_t>(axis.node))
                                         : mechanism.loop_pose(static_cast<std::size_t>(axis.loop));
  const auto b = static_cast<std::size_t>(joint.b);
  const bool turns = world::info(joint.kind).is_angle;
  Vector3d motion = turns ? bodies.w[b] : bodies.v[b] + bodies.w[b].cross(pose.pb - bodies.x[b]);
  if (joint.a >= 0) {
    const auto a = static_cast<std::size_t>(joint.a);
    motion -= turns ? bodies.w[a] : bodies.v[a] + bodies.w[a].cross(pose.pb - bodies.x[a]);
  }
  return pose.a.dot(motion);
}

}  // namespace visum::dynamics::impulse
