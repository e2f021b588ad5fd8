#include "server/gateway/holders.h"

#include <algorithm>

namespace visum::gateway {

void Holders::note(std::uint64_t session, bool is_joint, const std::string& name) {
  const auto found = std::ranges::find_if(
      held_, [&](const Held& held) { return held.is_joint == is_joint && held.name == name; });
  if (found != held_.end() && session == 0)
    held_.erase(found);
  else if (found != held_.end())
    found->session = session;
  else if (session != 0 && held_.size() < kMost)
    held_.push_back({session, is_joint, name});
}

void Holders::note_body(std::uint64_t session, const std::string& body) {
  note(session, false, body);
}

void Holders::note_joints(std::uint64_t session, const std::vector<std::string>& joints) {
  for (const auto& joint : joints) note(session, true, joint);
}

void Holders::end(cycle::Simulation& simulation, std::uint64_t session) {
  simulation.release_all_of(session);
  std::vector<world::JointPlacement> joints;
  const auto& model = simulation.model();
  for (const auto& held : held_) {
    if (held.session != session) continue;
    if (held.is_joint) {
      const auto joint = model.find_joint(held.name);
      if (!joint.valid() || !model.bodies[model.joints[joint.index()].child.index()].kinematic) continue;
      const auto& now = simulation.state().joints[joint.index()];
      if (now.velocity != 0.0) joints.push_back({joint, now.position, 0.0});
    } else if (const auto body = model.find_body(held.name);
               body.valid() && model.bodies[body.index()].kinematic) {
      // A refusal means that the world is frozen: then nothing moves.
      static_cast<void>(
          simulation.set_body(body, std::nullopt, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()));
    }
  }
  if (!joints.empty()) static_cast<void>(simulation.set_joints(joints));
  std::erase_if(held_, [&](const Held& held) { return held.session == session; });
}

}  // namespace visum::gateway
