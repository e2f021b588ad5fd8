// What is asked of the world's truth, and the streams of samples.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "protocol/config/unknown_name.h"
#include "server/gateway/gateway.h"

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

protocol::ContactSample to_sample(const collision::Contact& contact) {
  const auto& p = contact.p_W;
  const auto& n = contact.normal_W;
  return {static_cast<std::uint32_t>(contact.body_a.value),
          static_cast<std::uint32_t>(contact.body_b.value),
          {p.x(), p.y(), p.z()},
          {n.x(), n.y(), n.z()},
          contact.depth,
          contact.normal_force_n};
}

}  // namespace

void Gateway::handle(const Call& call, const protocol::DescribeWorld&) {
  call.reply(world_.view.description);
}

void Gateway::handle(const Call& call, const protocol::ReadMesh& request) {
  if (request.mesh >= world_.view.meshes.size())
    return call.fail(ErrorCode::kUnknownName,
                     "there are " + std::to_string(world_.view.meshes.size()) + " meshes");
  call.reply(world_.view.meshes[request.mesh]);
}

void Gateway::handle(const Call& call, const protocol::ReadTexture& request) {
  if (request.texture >= world_.view.textures.size())
    return call.fail(ErrorCode::kUnknownName,
                     "there are " + std::to_string(world_.view.textures.size()) + " textures");
  call.reply(world_.view.textures[request.texture]);
}

void Gateway::handle(const Call& call, const protocol::ReadWorld&) {
  call.reply(world_sample(call.client, *now_));
}

protocol::WorldSample Gateway::world_sample(Client& client, const Published& now) const {
  protocol::WorldSample sample;
  sample.tick = now.tick;
  sample.sim_time_ns = now.sim_time_ns;
  sample.era = now.era;
  sample.poses = now.poses;
  sample.velocities = now.velocities;
  sample.joint_positions = now.joint_positions;
  sample.joint_velocities = now.joint_velocities;
  sample.joint_efforts = now.joint_efforts;
  sample.following_errors = now.following_errors;
  sample.peak_following_errors.resize(now.joint_positions.size());
  sample.peak_contact_forces.resize(now.poses.size() / 7);
  if (!now.shown) {  // of another server's world no peaks are kept here
    now.ring->peaks(client.peaks_from, now.tick, sample.peak_following_errors, sample.peak_contact_forces);
    client.peaks_from = now.tick;
  }
  for (const auto& contact : now.contacts) sample.contacts.push_back(to_sample(contact));
  sample.state_hash = gateway::state_hash(now);
  sample.revision = now.revision;
  return sample;
}

void Gateway::handle(const Call& call, const protocol::SubscribeWorld& request) {
  subscribe(call, kWorldStream, request.every_n_ticks);
}

void Gateway::handle(const Call& call, const protocol::UnsubscribeWorld&) {
  unsubscribe(call, kWorldStream);
}

void Gateway::subscribe(const Call& call, std::uint32_t stream, std::uint32_t every) {
  if (every == 0) return call.fail(ErrorCode::kBadValue, "every_n_ticks must be at least 1");
  auto& list = call.client.subscriptions;
  std::erase_if(list, [stream](const Subscription& old) { return old.stream == stream; });
  list.push_back({stream, every, now_->tick, 0});
  call.reply(protocol::Ok{});
  send_sample(call.client, list.back(), *now_);
}

void Gateway::unsubscribe(const Call& call, std::uint32_t stream) {
  if (std::erase_if(call.client.subscriptions,
                    [stream](const Subscription& old) { return old.stream == stream; }) == 0)
    return call.fail(ErrorCode::kWrongState, "there is no such subscription");
  call.reply(protocol::Ok{});
}

void Gateway::send_samples(const Published& now) {
  for (auto& [id, client] : clients_)
    for (auto& subscription : client.subscriptions)
      if (subscription.next_tick <= now.tick) send_sample(client, subscription, now);
}

void Gateway::send_sample(Client& client, Subscription& subscription, const Published& now) {
  subscription.next_tick = now.tick + subscription.every;
  // Latest wins: what a slow reader has not been sent yet is replaced, and counted. Peaks of a world sample
  // that is replaced must not be lost, so that one is only made when the way is free.
  const bool free = client.session->ready_for(subscription.stream);
  if (!free) ++subscription.conflated;
  if (subscription.stream == kWorldStream) {
    if (!free) return;
    auto sample = world_sample(client, now);
    sample.conflated = subscription.conflated;
    client.session->send_latest(subscription.stream, sample);
    return;
  }
  auto sample = part_sample(subscription.stream, now);
  sample.conflated = subscription.conflated;
  client.session->send_latest(subscription.stream, sample);
}

void Gateway::handle(const Call& call, const protocol::PushBody& request) {
  const auto& bodies = world_.view.description.bodies;
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
  constexpr std::int64_t kLongest = 3'600'000'000'000;
  if (request.duration_ns <= 0 || request.duration_ns > kLongest)
    return call.fail(ErrorCode::kBadValue, "duration_ns must be within 1 and one hour");
  auto* input = input_or_fail(call);
  if (!input) return;
  const auto body = static_cast<std::int32_t>(found - bodies.begin());
  input->kind = Input::Kind::kPush;
  input->part = 0;
  input->epoch = order_of(call);
  input->wrench = {world::BodyId{body}, to_vector(request.force_n), to_vector(request.torque_nm)};
  input->revision = world_.view.description.revision;
  input->push_point = request.point_m.empty() ? std::nullopt : std::optional(to_vector(request.point_m));
  input->duration_ticks = (request.duration_ns + world_.tick_ns - 1) / world_.tick_ns;
  mailbox_.send(input);
  call.reply(protocol::Ok{});
}

void Gateway::handle(const Call& call, const protocol::AddBody& request) {
  send_command(call, request);
}
void Gateway::handle(const Call& call, const protocol::RemoveBody& request) {
  send_command(call, request);
}

}  // namespace visum::gateway
