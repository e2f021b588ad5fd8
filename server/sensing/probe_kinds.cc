#include <array>
#include <stdexcept>
#include <string>

#include "server/sensing/probes.h"

namespace visum::sensing {
namespace {

constexpr std::array<ProbeKind, 7> kKinds{{
    {"distance", make_distance_probe},
    {"scanner", make_scanner_probe},
    {"imu", make_imu_probe},
    {"pose", make_pose_probe},
    {"contact", make_contact_probe},
    {"joint_wrench", make_joint_wrench_probe},
    {"camera", make_camera_probe},
}};

}  // namespace

std::span<const ProbeKind> probe_kinds() {
  return kKinds;
}

std::unique_ptr<Probe> make_probe(const std::string& kind, const ProbeContext& context) {
  for (const auto& row : kKinds)
    if (kind == row.name) return row.make(context);
  throw std::logic_error("the world has nothing for a sensor of kind '" + kind + "'");
}

world::Pose pose_of(const Mount& mount, const world::WorldModel& model, const world::WorldState& state) {
  if (!mount.body.valid()) return mount.X_BS;
  const std::size_t body = mount.body.index();
  return world::link_pose(model.bodies[body], state.bodies[body]) * mount.X_BS;
}

Eigen::Vector3d velocity_of(const Mount& mount, const world::WorldModel& model,
                            const world::WorldState& state) {
  if (!mount.body.valid()) return Eigen::Vector3d::Zero();
  const world::BodyState& body = state.bodies[mount.body.index()];
  return body.v_WC + body.w_WB.cross(pose_of(mount, model, state).p - body.p_WC);
}

}  // namespace visum::sensing
