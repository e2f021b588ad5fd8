// Client::chain: the chain of driven joints that carries a body of the world.
#include <algorithm>
#include <limits>

#include "clients/cpp/client_state.h"
#include "clients/cpp/kinematics.h"
#include "protocol/config/unknown_name.h"

namespace visum {
namespace {

constexpr std::size_t kMostJoints = 64;  // also bounds the way to the root

Pose pose_at(const std::vector<double>& numbers, std::size_t at) {
  if (numbers.size() < at + 7) return {};
  return {{numbers[at], numbers[at + 1], numbers[at + 2]},
          {numbers[at + 3], numbers[at + 4], numbers[at + 5], numbers[at + 6]}};
}

class World {
 public:
  World(const protocol::WorldDescription& description, const protocol::WorldSample& sample)
      : description_(description), sample_(sample) {}

  // The joint that carries a body; size() of the joints: none does.
  std::size_t carrier(const std::string& body) const {
    const auto& joints = description_.joints;
    const auto found = std::ranges::find(joints, body, &protocol::JointDescription::child);
    return static_cast<std::size_t>(found - joints.begin());
  }

  Pose pose_of(const std::string& body) const {
    if (body.empty()) return {};
    const auto found = std::ranges::find(description_.bodies, body, &protocol::BodyDescription::name);
    return pose_at(sample_.poses, 7 * static_cast<std::size_t>(found - description_.bodies.begin()));
  }

  // The child's pose in the parent's frame.
  Pose across(const protocol::JointDescription& joint) const {
    return compose(inverse_of(pose_of(joint.parent)), pose_of(joint.child));
  }

  ChainJoint link(std::size_t number) const {
    const auto& joint = description_.joints[number];
    ChainJoint link;
    link.name = joint.name;
    link.part = joint.part;
    link.slides = joint.type == "slider";
    link.frame = pose_at(joint.pose, 0);
    std::copy_n(joint.axis.begin(), std::min<std::size_t>(3, joint.axis.size()), link.axis.begin());
    const bool limited = joint.upper > joint.lower;
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    link.lower = limited ? joint.lower : -kInfinite;
    link.upper = limited ? joint.upper : kInfinite;
    // Where the child's frame is behind the joint shows in where it is now.
    const Chain alone({}, {link});
    const double now = number < sample_.joint_positions.size() ? sample_.joint_positions[number] : 0.0;
    link.child = compose(inverse_of(alone.forward(std::span(&now, 1))), across(joint));
    return link;
  }

  bool is_driven(const protocol::JointDescription& joint) const {
    return !joint.part.empty() && (joint.type == "hinge" || joint.type == "slider");
  }

 private:
  const protocol::WorldDescription& description_;
  const protocol::WorldSample& sample_;
};

}  // namespace

Chain Client::chain(const std::string& body) {
  const auto description = state_->request_as<protocol::WorldDescription>(protocol::DescribeWorld{});
  const auto sample = state_->request_as<protocol::WorldSample>(protocol::ReadWorld{});
  std::vector<std::string> names;
  for (const auto& one : description.bodies) names.push_back(one.name);
  if (std::ranges::find(names, body) == names.end())
    throw Error(ErrorCode::kUnknownName, config::unknown_name("body", body, names));
  const World world(description, sample);
  std::vector<ChainJoint> joints;  // from the tool to the base
  Pose rest;                       // of undriven joints behind the next driven one
  std::string base = body;
  for (std::size_t step = 0; step < kMostJoints; ++step) {
    const auto number = world.carrier(base);
    if (number == description.joints.size()) break;
    const auto& joint = description.joints[number];
    if (world.is_driven(joint)) {
      joints.push_back(world.link(number));
      joints.back().child = compose(joints.back().child, std::exchange(rest, {}));
    } else {
      rest = compose(world.across(joint), rest);
    }
    base = joint.parent;
    if (base.empty()) break;
  }
  if (joints.empty()) throw Error(ErrorCode::kMisuse, "no part drives a joint that carries '" + body + "'");
  std::ranges::reverse(joints);
  joints.front().frame = compose(rest, joints.front().frame);
  return Chain(base, std::move(joints));
}

}  // namespace visum
