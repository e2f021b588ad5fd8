// Sessions over WebSocket: the same messages, rights and limits as over TCP.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/limits.h"
#include "protocol/reading_window.h"
#include "tests/gateway/http_client.h"
#include "tests/gateway/running_daemon.h"

namespace visum::gateway {
namespace {

using namespace protocol;
using testing::WebClient;

constexpr int kPolicyError = 1008, kGoingAway = 1001;  // RFC 6455, section 7.4.1

DaemonOptions with_http() {
  DaemonOptions options;
  options.http.on = true;
  options.http.port = 0;
  options.models = std::filesystem::path(VISUM_SOURCE_DIR) / "models";
  return options;
}

class WebSessionTest : public ::testing::Test {
 protected:
  Welcome greet(WebClient& client, Role role = Role::kController) {
    return client.ask<Welcome>(Hello{1, 1, "page", role, {}});
  }
  // The loss is noticed between two ticks: at the latest when the next lease is asked for again.
  void expect_lease_becomes_free() {
    auto tcp = daemon_.connect("tcp", Role::kController);
    for (int i = 0; i < 10'000; ++i) {
      try {
        return void(tcp.request(AcquireLease{"arm"}));
      } catch (const RequestError& error) {
        ASSERT_EQ(error.code(), ErrorCode::kLeased);
      }
    }
    FAIL() << "the lease is still held";
  }
  std::uint16_t http() const { return daemon_.http_port(); }
  RunningDaemon daemon_{scene::ClockKind::kLockstep, with_http()};
};
using WebSession = WebSessionTest;

TEST_F(WebSession, GetsTheSameWelcomeAsOverTcp) {
  WebClient web(http());
  const auto over_web = greet(web, Role::kObserver);
  const auto over_tcp = daemon_.connect("tcp", Role::kObserver).welcome();
  EXPECT_EQ(over_web.scene, over_tcp.scene);
  EXPECT_EQ(over_web.role, Role::kObserver);
  EXPECT_EQ(over_web.tick_ns, over_tcp.tick_ns);
}

TEST_F(WebSession, CommandsAPartAndStepsWithTheWorld) {
  WebClient web(http());
  greet(web);
  web.ask<LeaseGrant>(AcquireLease{"arm"});
  web.ask<Advanced>(Join{});
  EXPECT_EQ(web.ask<Advanced>(Advance{10}).tick, 10);
  auto observer = daemon_.connect("observer", Role::kObserver);
  EXPECT_EQ(observer.request_as<ServerStatus>(Status{}).tick, 10);
}

TEST_F(WebSession, ALeaseKeepsTheOtherDoorOut) {
  WebClient web(http());
  greet(web);
  web.ask<LeaseGrant>(AcquireLease{"arm"});
  auto tcp = daemon_.connect("tcp", Role::kController);
  EXPECT_EQ(refusal_of([&] { tcp.request(AcquireLease{"arm"}); }).code(), ErrorCode::kLeased);
}

TEST_F(WebSession, RolesHold) {
  WebClient web(http());
  greet(web, Role::kObserver);
  EXPECT_EQ(web.ask<Error>(AcquireLease{"arm"}).code, ErrorCode::kForbidden);
}

TEST_F(WebSession, TheFirstMessageMustBeHello) {
  WebClient web(http());
  web.send(1, Status{});
  EXPECT_EQ(web.closing_code(), kPolicyError);
}

TEST_F(WebSession, MessagesMustBeBinary) {
  WebClient web(http());
  web.send_text("{\"hello\": 1}");
  EXPECT_EQ(web.closing_code(), kPolicyError);
}

TEST_F(WebSession, PagesOfOtherOriginsGetNone) {
  EXPECT_THROW(WebClient(http(), "http://evil.example"), std::runtime_error);
}

// Each tick's samples of the arm and of the world, with and without compression.
TEST_F(WebSession, SamplesTakeLessOnTheWireWhereTheClientOffersCompression) {
  constexpr int kTicks = 200;
  struct Got {
    std::vector<double> poses, outputs;
    double share = 0.0;  // of the wire, in what the messages hold
  };
  const auto run = [&](bool compresses) {
    WebClient web(http(), "", compresses);
    greet(web);
    web.ask<LeaseGrant>(AcquireLease{"arm"});
    web.ask<Ok>(Subscribe{"arm", 1});
    web.ask<Ok>(SubscribeWorld{1});
    web.ask<Advanced>(Join{});
    const auto bytes = web.received_bytes(), wire = web.wire_bytes();
    for (int i = 0; i < kTicks; ++i) web.ask<Advanced>(Advance{1});
    Got got;
    got.share =
        static_cast<double>(web.wire_bytes() - wire) / static_cast<double>(web.received_bytes() - bytes);
    got.poses = web.ask<WorldSample>(ReadWorld{}).poses;
    got.outputs = web.ask<PartSample>(Read{"arm"}).sensor_outputs;
    web.ask<Ok>(Leave{});
    web.ask<Ok>(ReleaseLease{"arm"});
    daemon_.connect("admin", Role::kAdmin).request(Reset{});
    return got;
  };
  const Got plain = run(false), compressed = run(true);
  EXPECT_GT(plain.share, 1.0);
  EXPECT_LT(compressed.share, 0.7);
  EXPECT_EQ(compressed.poses, plain.poses);
  EXPECT_EQ(compressed.outputs, plain.outputs);
}

// A few kilobytes on the wire that would unpack to a frame of 60 MB. Who has not said Hello may send a small
// one.
TEST_F(WebSession, WhatUnpacksToTooMuchIsRefused) {
  WebClient web(http(), "", true);
  std::vector<std::byte> bomb(60u << 20, std::byte{1});
  const std::uint32_t length = (60u << 20) - kHeaderBytes;
  for (std::size_t i = 0; i < kHeaderBytes; ++i) bomb[i] = std::byte((length >> (8 * i)) & 0xFF);
  web.send_bytes(bomb);
  web.closing_code();  // waits for the end
  EXPECT_NE(testing::http_get(http(), "/metrics").body.find("\nvisum_refused_connections_total 1\n"),
            std::string::npos);
  WebClient other(http());
  EXPECT_EQ(greet(other, Role::kObserver).role, Role::kObserver);
}

// A page that is told so describes the world anew.
TEST_F(WebSession, IsToldOfAnotherScene) {
  WebClient web(http());
  greet(web, Role::kObserver);
  web.ask<Ok>(SubscribeWorld{1});
  daemon_.connect("admin", Role::kAdmin).request(LoadScene{"cart"});
  std::vector<std::string> told;
  while (told.empty() || told.back() != "world_changed")
    if (const auto frame = web.next(); const auto* event = std::get_if<Event>(&frame.reply))
      told.push_back(event->kind);
  EXPECT_NE(std::ranges::find(told, "era"), told.end());
  const auto world = web.ask<WorldDescription>(DescribeWorld{});
  EXPECT_EQ(world.scene, "cart");
  const auto sample = web.ask<WorldSample>(ReadWorld{});
  EXPECT_EQ(sample.revision, world.revision);
  EXPECT_EQ(sample.poses.size(), 7 * world.bodies.size());
}

TEST_F(WebSession, SaysWhyItEndsWhenTheDaemonDoes) {
  WebClient web(http());
  greet(web);
  daemon_.connect("admin", Role::kAdmin).request(Shutdown{});
  EXPECT_EQ(web.closing_code(), kGoingAway);
}

// A page that is lost stops its part, as any controller that vanishes does.
TEST_F(WebSession, ALostPageLosesItsLease) {
  {
    WebClient web(http());
    greet(web);
    web.ask<LeaseGrant>(AcquireLease{"arm"});
  }
  expect_lease_becomes_free();
}

// A browser says goodbye when a tab closes. The transport below closes its socket by itself then.
TEST_F(WebSession, APageThatSaysGoodbyeLosesItsLease) {
  WebClient web(http());
  greet(web);
  web.ask<LeaseGrant>(AcquireLease{"arm"});
  web.say_goodbye();
  expect_lease_becomes_free();
}

TEST_F(WebSession, APageThatSaidGoodbyeIsSentNothingMore) {
  auto controller = daemon_.connect("controller");
  controller.request(Join{});
  for (int i = 0; i < 20; ++i) {
    WebClient web(http());
    greet(web, Role::kObserver);
    web.ask<Ok>(Subscribe{"arm", 1});
    web.ask<Ok>(SubscribeWorld{1});
    web.say_goodbye();
    advance(controller, 5);
  }
  std::uint32_t sessions = 0;
  for (int i = 0; i < 10'000 && sessions != 1; ++i)
    sessions = controller.request_as<ServerStatus>(Status{}).sessions;
  EXPECT_EQ(sessions, 1u) << "the controller's own";
}

// A page that asks for all its pictures at once, behind a request that waits for the world.
TEST_F(WebSession, APageThatAsksForMuchBehindAStepKeepsItsLease) {
  constexpr std::uint64_t kMany = 60;
  WebClient page(http());
  greet(page);
  page.ask<LeaseGrant>(AcquireLease{"arm"});
  auto member = daemon_.connect("member");
  member.request(Join{});
  page.ask<Advanced>(Join{});
  const auto before = page.received_bytes();
  page.send(100, Advance{1});
  for (std::uint64_t i = 1; i <= kMany; ++i) page.send(100 + i, DescribeWorld{});
  while (member.request_as<ServerStatus>(Status{}).lockstep.at(1).granted_tick < 1) continue;
  advance(member, 1);
  for (std::uint64_t i = 0; i <= kMany; ++i) EXPECT_EQ(page.next().reply_to, 100 + i);
  EXPECT_GT(page.received_bytes() - before, 3 * Limits().max_queued_bytes) << "more than may wait";
  EXPECT_LE(page.longest_message(), ReadingWindow::kPiece) << "a browser shows its page whole ones only";
  page.ask<Ok>(ReleaseLease{"arm"});
}

// A page that does not run, asleep or on a busy machine, holds up no other client. It keeps its session and
// is sent no more than a window. So it does not have to read megabytes of the past when it wakes.
TEST_F(WebSession, APageThatDoesNotReadIsSentNoMoreThanAWindow) {
  constexpr std::int64_t kTicks = 1000;
  WebClient page(http());
  greet(page, Role::kObserver);
  page.ask<Ok>(Subscribe{"arm", 1});
  page.ask<Ok>(SubscribeWorld{1});
  const auto before = page.received_bytes();
  auto controller = daemon_.connect("controller");
  controller.request(Join{});
  for (std::int64_t tick = 1; tick <= kTicks; ++tick) EXPECT_EQ(advance(controller, 1).tick, tick);
  page.send(100, Status{});
  PartSample newest;
  for (auto frame = page.next(); frame.reply_to != 100; frame = page.next())
    if (const auto* sample = std::get_if<PartSample>(&frame.reply)) newest = *sample;
  EXPECT_EQ(newest.tick, kTicks) << "the newest sample comes before the reply";
  EXPECT_GT(newest.conflated, kTicks / 2) << "what was not sent must be much";
  const auto window = ReadingWindow::kBytes + ReadingWindow::kPiece;
  EXPECT_LT(page.received_bytes() - before, 2 * window);
}

}  // namespace
}  // namespace visum::gateway
