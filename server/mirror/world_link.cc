#include "server/mirror/world_link.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace visum::mirror {
namespace {

using protocol::Connection;

constexpr std::int64_t kEvery_ns =
    4'000'000;  // the page draws each 16 ms: a sample is at most a quarter of that old

// Reads all meshes or textures of a world.
template <typename Data, typename Request>
std::vector<Data> read_all(Connection& link, std::size_t count) {
  std::vector<Data> all;
  for (std::uint32_t i = 0; i < count; ++i) all.push_back(link.request_as<Data>(Request{i}));
  return all;
}

std::size_t mesh_count(const protocol::WorldDescription& world) {
  std::size_t count = 0;
  for (const auto& body : world.bodies)
    for (const auto& shape : body.shapes)
      if (shape.kind == "mesh" || shape.kind == "convex")
        count = std::max<std::size_t>(count, shape.mesh + 1u);
  return count;
}

std::size_t texture_count(const protocol::WorldDescription& world) {
  std::size_t count = 0;
  for (const auto& material : world.materials) count = std::max<std::size_t>(count, material.texture);
  return count;
}

Eigen::Vector3d to_vector(const std::vector<double>& numbers) {
  return numbers.size() == 3 ? Eigen::Vector3d(numbers.data()) : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

collision::Contact to_contact(const protocol::ContactSample& sample) {
  collision::Contact contact;
  contact.body_a.value = static_cast<std::int32_t>(sample.body_a);
  contact.body_b.value = static_cast<std::int32_t>(sample.body_b);
  contact.p_W = to_vector(sample.position);
  contact.normal_W = to_vector(sample.normal);
  contact.depth = sample.depth;
  contact.normal_force_n = sample.normal_force_n;
  return contact;
}

}  // namespace

WorldLink::WorldLink(std::string address, Entry entry)
    : address_(std::move(address)), entry_(std::move(entry)) {
  try {
    adopt(find(address_, entry_));
  } catch (const std::exception& error) {
    throw std::runtime_error(address_ + ": " + error.what());
  }
}

WorldLink::Found WorldLink::find(const std::string& address, const Entry& entry) {
  const auto [host, port] = protocol::parse_address(address);
  Connection link(host, port, {1, 1, "visum-mirror", protocol::Role::kObserver, entry.token}, kConnectTimeout,
                  entry.tls);
  auto view = std::make_shared<gateway::WorldView>();
  view->description = link.request_as<protocol::WorldDescription>(protocol::DescribeWorld{});
  const auto& world = view->description;
  if (!link.welcome().simulated || world.bodies.empty()) return {std::move(link), nullptr, {}};
  view->meshes = read_all<protocol::MeshData, protocol::ReadMesh>(link, mesh_count(world));
  view->textures = read_all<protocol::TextureData, protocol::ReadTexture>(link, texture_count(world));
  const auto every = std::max<std::int64_t>(1, kEvery_ns / std::max<std::int64_t>(1, world.tick_ns));
  auto sample = link.request_as<protocol::WorldSample>(protocol::ReadWorld{});
  link.request(protocol::SubscribeWorld{static_cast<std::uint32_t>(every)});
  return {std::move(link), std::move(view), std::move(sample)};
}

void WorldLink::adopt(Found found) {
  connection_.reset();
  if (found.view) connection_ = std::move(found.connection);
  view_ = std::move(found.view);
  sample_ = std::move(found.sample);
  stale_ = false;
}

void WorldLink::poll() {
  if (!has_world()) return;
  if (!connection_ || stale_) return look_again();
  try {
    while (auto reply = connection_->next(std::chrono::milliseconds(0))) take(*reply);
  } catch (const std::exception& error) {
    spdlog::warn("{}: its world is not shown any more: {}", address_, error.what());
    connection_.reset();
    tried_ = Clock::now();
  }
}

void WorldLink::take(const protocol::Reply& reply) {
  if (const auto* sample = std::get_if<protocol::WorldSample>(&reply)) {
    if (sample->poses.size() == 7 * view_->description.bodies.size()) sample_ = *sample;
  } else if (const auto* event = std::get_if<protocol::Event>(&reply)) {
    stale_ = stale_ || event->kind == "world_changed";
  }
}

void WorldLink::look_again() {
  using namespace std::chrono_literals;
  if (!search_.valid()) {
    if (Clock::now() - tried_ < kRetryPeriod) return;
    tried_ = Clock::now();
    search_ =
        std::async(std::launch::async, [address = address_, entry = entry_] { return find(address, entry); });
  }
  if (search_.wait_for(0s) != std::future_status::ready) return;
  try {
    auto found = search_.get();
    if (found.view) adopt(std::move(found));
  } catch (const std::exception& error) {
    spdlog::debug("{}: {}", address_, error.what());
  }
}

void WorldLink::fill(gateway::Published& published) const {
  if (!has_world()) return;
  published.shown = view_;
  published.revision = view_->description.revision;
  published.poses = sample_.poses;
  published.velocities = sample_.velocities;
  published.joint_positions = sample_.joint_positions;
  published.joint_velocities = sample_.joint_velocities;
  published.joint_efforts = sample_.joint_efforts;
  published.following_errors = sample_.following_errors;
  published.contacts.clear();
  for (const auto& contact : sample_.contacts) published.contacts.push_back(to_contact(contact));
}

}  // namespace visum::mirror
