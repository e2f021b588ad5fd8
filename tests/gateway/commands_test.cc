// A request behind a command is never answered from a copy of the world that is older than the command. Both
// sides of the mailbox have threads of their own here.
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "server/gateway/gateway.h"
#include "server/gateway/tick_side.h"
#include "server/scene/scene.h"

namespace visum::gateway {
namespace {

class AdminSession final : public protocol::Session {
 public:
  std::uint64_t id() const override { return 1; }
  const std::string& client_name() const override { return name_; }
  const std::string& peer() const override { return name_; }
  protocol::Role role() const override { return protocol::Role::kAdmin; }
  std::size_t request_bytes() const override { return 0; }
  void send(std::uint64_t reply_to, const protocol::Reply& reply) override { replies[reply_to] = reply; }
  bool send_latest(std::uint32_t, const protocol::Reply&) override { return true; }
  bool behind() const override { return false; }
  bool ready_for(std::uint32_t) const override { return true; }
  void log(protocol::LogLevel, const std::string&) override {}
  void close(protocol::CloseReason) override {}

  std::map<std::uint64_t, protocol::Reply> replies;  // by request's id; 0: the last event

 private:
  const std::string name_ = "admin";
};

scene::Scene two_link_in_real_time() {
  auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/two_link.yaml");
  scene.clock = scene::ClockKind::kRealtime;
  return scene;
}

class Commands : public ::testing::Test {
 protected:
  Commands() {
    publish();
    protocol::Welcome welcome;
    protocol::Error refusal;
    gateway.on_hello(session, {1, 1, "admin", protocol::Role::kAdmin, {}}, welcome, refusal);
  }
  // The tick's side, as in the daemon.
  void publish() {
    fill(newest, simulation, tick_side.pace(), tick_side.part_table());
    tick_side.give_back();
  }
  void do_commands() {
    tick_side.empty_mailbox();
    publish();
  }
  // The sessions' side takes a copy, and `meanwhile` happens before it goes on.
  const Published& latest() {
    taken = newest;
    if (const auto now = std::exchange(meanwhile, nullptr)) now();
    return taken;
  }
  template <typename Reply>
  const Reply& reply_to(std::uint64_t id) {
    return std::get<Reply>(session.replies.at(id));
  }

  cycle::Simulation simulation{two_link_in_real_time()};
  Mailbox mailbox{64};
  TickSide tick_side{simulation, mailbox, true};
  Published newest, taken;
  std::function<void()> meanwhile;
  Gateway gateway{static_world(simulation),
                  {},
                  mailbox,
                  tick_side.stops(),
                  tick_side.pacer(),
                  [this]() -> const Published& { return latest(); }};
  AdminSession session;
};

TEST_F(Commands, ComeBackOnceThereIsACopyOfWhatTheyDid) {
  gateway.on_request(session, 1, protocol::Reset{});
  gateway.on_request(session, 2, protocol::ReadWorld{});
  tick_side.empty_mailbox();
  gateway.serve();  // the reset is done, but no copy is published yet
  EXPECT_TRUE(session.replies.empty());
  publish();
  gateway.serve();
  EXPECT_EQ(reply_to<protocol::WorldSample>(2).era, 2u);
}

TEST_F(Commands, ThatComeBackWhileACopyIsTakenWaitForTheNext) {
  gateway.on_request(session, 1, protocol::Reset{});
  gateway.on_request(session, 2, protocol::ReadWorld{});
  meanwhile = [this] { do_commands(); };
  gateway.serve();
  gateway.serve();
  EXPECT_TRUE(std::holds_alternative<protocol::Ok>(session.replies.at(1)));
  EXPECT_EQ(reply_to<protocol::WorldSample>(2).era, 2u);
}

TEST_F(Commands, AStepBehindAResetIsOfItsEra) {
  tick_side.tick();
  publish();
  gateway.serve();
  gateway.on_request(session, 1, protocol::Join{});
  gateway.on_request(session, 2, protocol::Reset{});
  gateway.on_request(session, 3, protocol::Advance{10});
  meanwhile = [this] { do_commands(); };
  gateway.serve();
  gateway.serve();
  EXPECT_FALSE(session.replies.contains(3)) << "ten ticks are to come";
  for (int i = 0; i < 10; ++i) tick_side.tick();
  publish();
  gateway.serve();
  EXPECT_EQ(reply_to<protocol::Advanced>(3).tick, 10);
}

}  // namespace
}  // namespace visum::gateway
