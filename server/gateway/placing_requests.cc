#include "server/gateway/placing_requests.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "server/gateway/pose_numbers.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

constexpr double kLeastForce_n = 1e-6;
constexpr std::size_t kMostJoints = 1000;
constexpr std::int64_t kLongest_ns = 3'600'000'000'000;

}  // namespace

void PlacingRequests::handle(const Call& call, const protocol::SetBody& request) {
  if (!request.pose.empty() && !is_pose(request.pose)) return call.fail(ErrorCode::kBadValue, kWrongPose);
  if (!is_list(request.velocity, 6, true))
    return call.fail(ErrorCode::kBadValue, "velocity needs six numbers, none beyond 1e6");
  call.client.holds_bodies = true;
  commands_.send(call, request);
}

void PlacingRequests::handle(const Call& call, const protocol::SetJoints& request) {
  if (request.joints.empty() || request.joints.size() > kMostJoints)
    return call.fail(ErrorCode::kBadValue, "1 to " + std::to_string(kMostJoints) + " joints can be set");
  const std::string prefix = request.model.empty() ? "" : request.model + "/";
  for (const auto& target : request.joints) {
    if (!(std::abs(target.position) <= kFarthest) || !(std::abs(target.velocity) <= kFarthest))
      return call.fail(ErrorCode::kBadValue,
                       "joint '" + target.name + "' was given a number that is not finite or beyond 1e6");
    const auto& joints = bodies_.description().joints;
    const auto joint = std::ranges::find(joints, prefix + target.name, &protocol::JointDescription::name);
    if (joint == joints.end() || joint->part.empty()) continue;
    if (const auto owner = parts_.leased_to_another(call, joint->part))
      return call.fail(
          ErrorCode::kLeased,
          "joint '" + joint->name + "' is driven by '" + joint->part + "', which '" + *owner + "' has leased",
          *owner);
  }
  call.client.holds_bodies = true;
  commands_.send(call, request);
}

void PlacingRequests::handle(const Call& call, const protocol::PullBody& request) {
  if (!is_list(request.point_m, 3, true) || !is_list(request.target_m, 3, false))
    return call.fail(ErrorCode::kBadValue, "point and target need three numbers each, none beyond 1e6");
  if (!(request.max_force_n >= kLeastForce_n && request.max_force_n <= kFarthest))
    return call.fail(ErrorCode::kBadValue, "max_force_n must be within 1e-6 and 1e6");
  if (request.duration_ns < 0 || request.duration_ns > kLongest_ns)
    return call.fail(ErrorCode::kBadValue, "duration_ns must be within 0 and one hour");
  call.client.holds_bodies = true;
  commands_.send(call, request);
}

void PlacingRequests::handle(const Call& call, const protocol::ReleaseBody& request) {
  commands_.send(call, request);
}

void PlacingRequests::end_session(const Client& client) {
  if (client.holds_bodies) ended_.push_back(client.session->id());
  serve();
}

void PlacingRequests::serve() {
  while (!ended_.empty()) {
    auto* input = mailbox_.blank_input(true);
    if (!input) return;
    input->kind = Input::Kind::kSessionEnded;
    input->part = 0;
    input->epoch = ended_.back();
    ended_.pop_back();
    mailbox_.send(input);
  }
}

}  // namespace visum::gateway
