#include "server/gateway/world_requests.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "protocol/config/unknown_name.h"
#include "server/gateway/model_files.h"
#include "server/gateway/pose_numbers.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

bool is_vector(const std::vector<double>& numbers, bool may_be_absent) {
  if (may_be_absent && numbers.empty()) return true;
  constexpr double kMost = 1e6;  // N, N·m, m
  return numbers.size() == 3 && std::ranges::all_of(numbers, [](double n) { return std::abs(n) <= kMost; });
}

Eigen::Vector3d to_vector(const std::vector<double>& numbers) {
  return numbers.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : Eigen::Vector3d(numbers.data());
}

}  // namespace

void WorldRequests::handle(const Call& call, const protocol::ReadMesh& request) {
  if (request.mesh >= view_->meshes.size())
    return call.fail(ErrorCode::kUnknownName,
                     "there are " + std::to_string(view_->meshes.size()) + " meshes");
  call.reply(view_->meshes[request.mesh]);
}

void WorldRequests::handle(const Call& call, const protocol::ReadTexture& request) {
  if (request.texture >= view_->textures.size())
    return call.fail(ErrorCode::kUnknownName,
                     "there are " + std::to_string(view_->textures.size()) + " textures");
  call.reply(view_->textures[request.texture]);
}

void WorldRequests::handle(const Call& call, const protocol::PushBody& request) {
  const auto& bodies = view_->description.bodies;
  const auto found = std::ranges::find(bodies, request.body, &protocol::BodyDescription::name);
  if (found == bodies.end()) {
    std::vector<std::string> known;
    for (const auto& body : bodies) known.push_back(body.name);
    return call.fail(ErrorCode::kUnknownName, config::unknown_name("body", request.body, known));
  }
  if (found->fixed) return call.fail(ErrorCode::kWrongState, "'" + request.body + "' is fixed");
  if (!is_vector(request.force_n, false) || !is_vector(request.torque_nm, true) ||
      !is_vector(request.point_m, true))
    return call.fail(ErrorCode::kBadValue,
                     "force, torque and point need three numbers each, none beyond 1e6");
  constexpr std::int64_t kLongest_ns = 3'600'000'000'000;
  if (request.duration_ns <= 0 || request.duration_ns > kLongest_ns)
    return call.fail(ErrorCode::kBadValue, "duration_ns must be within 1 and one hour");
  auto* input = limiter_.blank_or_fail(call);
  if (!input) return;
  const auto body = static_cast<std::int32_t>(found - bodies.begin());
  input->kind = Input::Kind::kPush;
  input->part = 0;
  input->epoch = order_of(call);
  input->wrench = {world::BodyId{body}, to_vector(request.force_n), to_vector(request.torque_nm)};
  input->revision = view_->description.revision;
  input->push_point = request.point_m.empty() ? std::nullopt : std::optional(to_vector(request.point_m));
  input->duration_ticks = world_.to_ticks(request.duration_ns);
  mailbox_.send(input);
  call.reply(protocol::Ok{});
}

// Refused here already, so that a text that is too long is not copied. The thread that reads it checks again.
void WorldRequests::handle(const Call& call, const protocol::AddBody& request) {
  if (const auto fault = scene::too_long_for_body(request.yaml); !fault.empty())
    return call.fail(ErrorCode::kBadValue, "the body " + fault);
  commands_.send(call, request);
}

const std::vector<std::string>& WorldRequests::models() {
  if (!models_) models_ = world_.models.empty() ? std::vector<std::string>() : models_in(world_.models);
  return *models_;
}

void WorldRequests::handle(const Call& call, const protocol::ListModels&) {
  protocol::ModelList list{models(), {}};
  for (const auto& spawned : view_->spawned) list.spawned.push_back(spawned.name);
  call.reply(list);
}

void WorldRequests::handle(const Call& call, const protocol::SpawnModel& request) {
  if (!request.pose.empty() && !is_pose(request.pose)) return call.fail(ErrorCode::kBadValue, kWrongPose);
  if (request.name.size() > protocol::kMostPathBytes)
    return call.fail(ErrorCode::kBadValue, "the model's name is too long");
  if (!request.files.empty()) {
    if (const auto fault = fault_of_files(request); !fault.empty())
      return call.fail(ErrorCode::kBadValue, fault);
  } else if (std::ranges::find(models(), request.file) == models().end()) {
    return call.fail(ErrorCode::kUnknownName, config::unknown_name("model", request.file, models()));
  }
  commands_.send(call, request);
}

void WorldRequests::handle(const Call& call, const protocol::RemoveModel& request) {
  const auto model = std::ranges::find(view_->spawned, request.name, &protocol::ModelSpawned::name);
  if (model != view_->spawned.end())
    for (const auto& part : model->parts)
      if (const auto owner = parts_.leased_to_another(call, part))
        return call.fail(ErrorCode::kLeased,
                         "the part '" + part + "' of the model is leased by '" + *owner + "'", *owner);
  commands_.send(call, request);
}

void WorldRequests::replace_view(WorldView view, const Published& now) {
  view_ = std::make_shared<const WorldView>(std::move(view));
  clients_.broadcast({"world_changed", "bodies or models came or went", {}, now.era, now.tick});
}

void WorldRequests::follow_shown_world(const Published& now) {
  if (now.shown == shown_) return;
  shown_ = now.shown;
  view_ = shown_;
  clients_.broadcast({"world_changed", "another world is shown", {}, now.era, now.tick});
}

}  // namespace visum::gateway
