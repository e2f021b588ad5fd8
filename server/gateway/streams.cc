#include "server/gateway/streams.h"

#include <algorithm>
#include <limits>

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

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

void Streams::handle(const Call& call, const protocol::Read& request) {
  if (const auto part = part_or_fail(call, world_, request.part)) call.reply(part_sample(*part, call.now));
}

void Streams::handle(const Call& call, const protocol::Subscribe& request) {
  if (const auto part = part_or_fail(call, world_, request.part))
    subscribe(call, *part, request.every_n_ticks);
}

void Streams::handle(const Call& call, const protocol::Unsubscribe& request) {
  if (const auto part = part_or_fail(call, world_, request.part)) unsubscribe(call, *part);
}

void Streams::handle(const Call& call, const protocol::ReadWorld&) {
  call.reply(world_sample(readers_.at(call.session.id()), call.now));
}

void Streams::handle(const Call& call, const protocol::SubscribeWorld& request) {
  subscribe(call, kWorldStream, request.every_n_ticks);
}

void Streams::handle(const Call& call, const protocol::UnsubscribeWorld&) {
  unsubscribe(call, kWorldStream);
}

void Streams::subscribe(const Call& call, std::uint32_t stream, std::uint32_t every) {
  if (every == 0) return call.fail(ErrorCode::kBadValue, "every_n_ticks must be at least 1");
  auto& reader = readers_.at(call.session.id());
  auto& list = reader.subscriptions;
  std::erase_if(list, [stream](const Subscription& old) { return old.stream == stream; });
  list.push_back({stream, every, call.now.tick, 0});
  call.reply(protocol::Ok{});
  send(reader, list.back(), call.now);
}

void Streams::unsubscribe(const Call& call, std::uint32_t stream) {
  if (std::erase_if(readers_.at(call.session.id()).subscriptions,
                    [stream](const Subscription& old) { return old.stream == stream; }) == 0)
    return call.fail(ErrorCode::kWrongState, "there is no such subscription");
  call.reply(protocol::Ok{});
}

void Streams::send_due(const Published& now) {
  for (auto& [id, reader] : readers_)
    for (auto& subscription : reader.subscriptions)
      if (subscription.next_tick <= now.tick) send(reader, subscription, now);
}

std::int64_t Streams::next_due() const {
  auto due = std::numeric_limits<std::int64_t>::max();
  for (const auto& [id, reader] : readers_)
    for (const auto& subscription : reader.subscriptions) due = std::min(due, subscription.next_tick);
  return due;
}

void Streams::forget_parts(std::span<const std::uint32_t> parts) {
  for (auto& [id, reader] : readers_)
    std::erase_if(reader.subscriptions, [&](const Subscription& one) {
      return std::ranges::find(parts, one.stream) != parts.end();
    });
}

void Streams::begin_era(const Published& now) {
  for (auto& [id, reader] : readers_) {
    reader.peaks_from = now.tick;
    for (auto& subscription : reader.subscriptions) subscription.next_tick = now.tick;
  }
}

void Streams::send(Reader& reader, Subscription& subscription, const Published& now) const {
  auto& session = *reader.session;
  subscription.next_tick = now.tick + subscription.every;
  const bool free = session.ready_for(subscription.stream);
  if (!free) ++subscription.conflated;
  if (subscription.stream == kWorldStream) {
    // A world sample that was replaced would take its peaks with it. So none is made while one waits.
    if (!free) return;
    auto sample = world_sample(reader, now);
    sample.conflated = subscription.conflated;
    session.send_latest(subscription.stream, sample);
    return;
  }
  auto sample = part_sample(subscription.stream, now);
  sample.conflated = subscription.conflated;
  session.send_latest(subscription.stream, sample);
}

protocol::PartSample Streams::part_sample(std::uint32_t part, const Published& now) const {
  const auto& values = now.parts[part];
  return {world_.part_name(part), now.tick, now.sim_time_ns, now.era, values.controller_inputs,
          values.sensor_outputs,  0};
}

protocol::WorldSample Streams::world_sample(Reader& reader, const Published& now) {
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
  if (!now.shown) {  // no peaks are kept of another server's world
    now.ring->peaks(reader.peaks_from, now.tick, sample.peak_following_errors, sample.peak_contact_forces);
    reader.peaks_from = now.tick;
  }
  for (const auto& contact : now.contacts) sample.contacts.push_back(to_sample(contact));
  sample.state_hash = state_hash(now);
  sample.revision = now.revision;
  return sample;
}

}  // namespace visum::gateway
