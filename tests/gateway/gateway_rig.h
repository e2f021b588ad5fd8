// A gateway and its world on one thread, with sessions that note what they are sent. The test decides when
// each of the two sides acts.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/gateway/gateway.h"
#include "server/gateway/tick_side.h"
#include "server/scene/scene.h"

namespace visum::gateway {

class NotedSession final : public protocol::Session {
 public:
  NotedSession(std::uint64_t id, std::string name, protocol::Role role)
      : id_(id), name_(std::move(name)), role_(role) {}

  std::uint64_t id() const override { return id_; }
  const std::string& client_name() const override { return name_; }
  const std::string& peer() const override { return name_; }
  protocol::Role role() const override { return role_; }
  std::size_t request_bytes() const override { return next_request_bytes; }
  void send(std::uint64_t reply_to, const protocol::Reply& reply) override {
    if (const auto* event = std::get_if<protocol::Event>(&reply)) return events.push_back(*event);
    replies.emplace_back(reply_to, reply);
  }
  bool behind() const override { return replies.size() >= room; }
  bool send_latest(std::uint32_t, const protocol::Reply&) override { return true; }
  bool ready_for(std::uint32_t) const override { return true; }
  void hold_back(bool on) override { holds_back = on; }
  void log(protocol::LogLevel, const std::string&) override {}
  void close(protocol::CloseReason) override {}

  std::vector<std::pair<std::uint64_t, protocol::Reply>> replies;
  std::vector<protocol::Event> events;
  std::size_t room = ~std::size_t{0};  // replies
  bool holds_back = false;
  std::size_t next_request_bytes = 0;  // as if the request had come in a frame of so many

 private:
  const std::uint64_t id_;
  const std::string name_;
  const protocol::Role role_;
};

class GatewayRig {
 public:
  explicit GatewayRig(scene::ClockKind clock, std::int64_t tick_ns = 1'000'000)
      : simulation(scene_of(clock, tick_ns)) {
    publish();
  }

  NotedSession& connect(const std::string& name, protocol::Role role = protocol::Role::kController) {
    auto& session = sessions_.emplace_back(sessions_.size() + 1, name, role);
    protocol::Welcome welcome;
    protocol::Error refusal;
    EXPECT_EQ(gateway.on_hello(session, {1, 1, name, role, {}}, welcome, refusal), role);
    return session;
  }
  // Returns the number of the request.
  std::uint64_t ask(NotedSession& session, const protocol::Request& request) {
    gateway.on_request(session, ++last_id_, request);
    return last_id_;
  }
  // The reply, which must come at once.
  template <typename T>
  T answer(NotedSession& session, const protocol::Request& request) {
    const auto id = ask(session, request);
    if (!session.replies.empty() && session.replies.back().first == id)
      if (const auto* reply = std::get_if<T>(&session.replies.back().second)) return *reply;
    ADD_FAILURE() << "no such answer from '" << session.client_name() << "'s request " << id;
    return {};
  }
  void leave(NotedSession& session, protocol::CloseReason reason) { gateway.on_close(session, reason); }

  // Only the tick's side acts; the sessions' side knows of it after publish().
  void tick() {
    tick_side.empty_mailbox();
    tick_side.tick();
  }
  void publish() {
    fill(copy_, simulation, tick_side.pace(), tick_side.part_table());
    tick_side.give_back();
  }
  void tell() {
    publish();
    gateway.serve();
  }
  double input(std::size_t port) const { return simulation.parts()[0].controller_inputs[port]; }

  cycle::Simulation simulation;
  Mailbox mailbox{64};
  TickSide tick_side{simulation, mailbox, true};

 private:
  static scene::Scene scene_of(scene::ClockKind clock, std::int64_t tick_ns) {
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
    scene.clock = clock;
    scene.world.tick_ns = tick_ns;
    return scene;
  }
  Published copy_;
  std::list<NotedSession> sessions_;
  std::uint64_t last_id_ = 0;

 public:
  Gateway gateway{static_world(simulation),
                  {},
                  mailbox,
                  tick_side.stops(),
                  tick_side.pacer(),
                  [this]() -> const Published& { return copy_; }};
};

}  // namespace visum::gateway
