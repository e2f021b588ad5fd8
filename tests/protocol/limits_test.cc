// Every limit of the server, with deadlines short enough for a test. The tests check that a deadline acts,
// and never too early. How late it acts depends on the machine and is not checked.
#include <gmock/gmock.h>

#include <sys/resource.h>

#include "tests/protocol/fixture.h"

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using testing::RawClient;

class Limited : public testing::ServerTest {
 protected:
  Limited() {
    options.limits.hello_deadline = options.limits.frame_deadline = options.limits.stall_deadline =
        milliseconds(60);
  }
};

// ---------------------------------------- deadlines

TEST_F(Limited, WithoutAHelloTheConnectionEnds) {
  RawClient silent(port());
  const auto began = std::chrono::steady_clock::now();
  const Error error = expect_refusal(silent);
  EXPECT_EQ(error.code, ErrorCode::kTimeout);
  EXPECT_EQ(error.text, "no Hello within 60 ms");
  EXPECT_GE(std::chrono::steady_clock::now() - began, milliseconds(55));
}

TEST_F(Limited, AHelloDrippingInByBytesDoesNotExtendItsTime) {
  options.limits.frame_deadline = milliseconds(10'000);
  RawClient slow(port()), good(port());
  greet(good);
  const auto hello =
      testing::frame_of(1, Hello{1, 1, std::string(60, 'x'), Role::kObserver, std::string(400, 't')});
  std::size_t sent = 0;
  auto last = std::chrono::steady_clock::now();
  EXPECT_TRUE(until([&] {
    if (const auto now = std::chrono::steady_clock::now();
        now - last > milliseconds(5) && sent < hello.size()) {
      last = now;
      slow.send(std::span(hello).subspan(sent++, 1));
    }
    return slow.reply().has_value();
  }));
  EXPECT_LT(sent, hello.size());
  good.send(2, Status{});
  expect<Ok>(good);
}

TEST_F(Limited, AFrameMustBeCompleteInItsTime) {
  RawClient client(port());
  greet(client);
  client.send(testing::header_of(100));
  const Error error = expect_refusal(client);
  EXPECT_EQ(error.code, ErrorCode::kTimeout);
  EXPECT_THAT(error.text, HasSubstr("a frame was not complete"));
  EXPECT_EQ(handler.closed.at(0).reason, CloseReason::kRefused);
}

TEST_F(Limited, ASilentSessionMayStayForever) {
  RawClient client(port());
  greet(client);
  const auto began = std::chrono::steady_clock::now();
  EXPECT_TRUE(until([&] { return std::chrono::steady_clock::now() - began > milliseconds(200); }));
  client.send(2, Status{});
  expect<Ok>(client);
}

TEST_F(Limited, TimeThatTheServerSpentElsewhereDoesNotCount) {
  RawClient client(port());
  ASSERT_TRUE(until([&] { return server().session_count() == 1; }));
  const auto began = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - began < milliseconds(150)) {
  }
  server().poll();
  greet(client);
}

TEST_F(Limited, AReaderThatStallsIsClosedWhileOthersAreServed) {
  RawClient stalled(port(), {.receive_buffer = 4096}), good(port());
  Session& session = greet(stalled);
  greet(good);
  std::int64_t tick = 0;
  EXPECT_TRUE(until([&] {
    if (handler.closed.empty())
      session.send_latest(1, PartSample{"arm", ++tick, 0, 1, std::vector<double>(5000), {}, 0});
    good.send(2, Status{});
    return !handler.closed.empty();
  }));
  EXPECT_EQ(handler.closed.at(0).reason, CloseReason::kLost);
  EXPECT_EQ(server().session_count(), 1u);
  expect<Ok>(good);
}

// ---------------------------------------- sizes

TEST_F(Limited, AFrameOverTheLimitIsRefusedByItsHeader) {
  RawClient client(port());
  greet(client, Role::kController);
  client.send(testing::header_of(static_cast<std::uint32_t>(options.limits.max_frame + 1)));
  const Error error = expect_refusal(client);
  EXPECT_EQ(error.code, ErrorCode::kTooLarge);
  EXPECT_THAT(error.text, HasSubstr("65537"));
}

TEST_F(Limited, BeforeHelloAFrameHasAtMost1KiB) {
  RawClient client(port());
  client.send(testing::header_of(1025));
  const Error error = expect_refusal(client);
  EXPECT_EQ(error.code, ErrorCode::kTooLarge);
  EXPECT_THAT(error.text, HasSubstr("before Hello"));
}

TEST_F(Limited, OnlyAnAdminMaySendLargeFrames) {
  options.limits.frame_deadline = milliseconds(10'000);
  RawClient admin(port());
  greet(admin, Role::kAdmin);
  const auto frame = testing::frame_of(2, AddBody{std::string(1u << 20, 'y')});
  std::span<const std::byte> left(frame);
  EXPECT_TRUE(until([&] {
    if (!left.empty()) left = left.subspan(admin.send(left));
    return !handler.asked.empty();
  }));
  EXPECT_EQ(std::get<AddBody>(handler.asked[0].request).yaml.size(), 1u << 20);
}

// ---------------------------------------- numbers

TEST_F(Limited, OneSessionTooManyIsToldSo) {
  options.limits.max_sessions = 2;
  options.limits.places_for_admins = 0;
  RawClient first(port()), second(port());
  greet(first);
  greet(second);
  RawClient third(port());
  third.send_hello(Role::kAdmin);
  const Error error = expect_refusal(third);
  EXPECT_EQ(error.code, ErrorCode::kBusy);
  EXPECT_EQ(error.text, "the limit of 2 sessions is reached");
  first.finish_sending();
  EXPECT_TRUE(until([&] { return server().session_count() == 1; }));
  RawClient fourth(port());
  greet(fourth);
}

TEST_F(Limited, PlacesAreKeptForAdmins) {
  options.limits.max_sessions = 2;
  options.limits.places_for_admins = 1;
  RawClient first(port()), second(port()), third(port());
  greet(first);
  second.send_hello(Role::kController);
  EXPECT_EQ(expect_refusal(second).text,
            "the limit of 2 sessions is reached, but for 1 that are kept for admins");
  EXPECT_EQ(handler.sessions.size(), 1u) << "the handler is told that it is gone";
  greet(third, Role::kAdmin);
  RawClient fourth(port());
  fourth.send_hello(Role::kAdmin);
  EXPECT_EQ(expect_refusal(fourth).text, "the limit of 2 sessions is reached");
}

TEST_F(Limited, OneAddressTakesItsShareOfTheSessionsOnly) {
  options.limits.max_sessions_per_local_peer = 2;
  options.limits.places_for_admins = 1;
  RawClient first(port()), second(port()), third(port());
  greet(first);
  greet(second);
  third.send_hello(Role::kController);
  const Error error = expect_refusal(third);
  EXPECT_EQ(error.code, ErrorCode::kBusy);
  EXPECT_EQ(error.text, "the limit of 2 sessions from one address is reached");
  RawClient elsewhere(port(), {.from = "127.0.0.2"}), admin(port());
  greet(elsewhere);
  greet(admin, Role::kAdmin);
}

// ---------------------------------------- clients that say nothing

TEST_F(Limited, ASilentClientYieldsItsPlaceToANewerOne) {
  options.limits.hello_deadline = milliseconds(10'000);
  options.limits.max_unauthenticated = 2;
  RawClient first(port()), second(port());
  EXPECT_TRUE(until([&] { return server().session_count() == 2; }));
  RawClient third(port());
  const Error error = expect_refusal(first);
  EXPECT_EQ(error.code, ErrorCode::kBusy);
  EXPECT_EQ(error.text, "its place was given to a newer connection, because it was silent");
  greet(second);
  greet(third);
}

TEST_F(Limited, SilentClientsOfOneAddressYieldBeforeThoseOfOthers) {
  options.limits.hello_deadline = milliseconds(10'000);
  options.limits.max_unauthenticated = 4;
  RawClient slow(port());
  ASSERT_TRUE(until([&] { return server().session_count() == 1; }));
  std::vector<std::unique_ptr<RawClient>> flood;
  for (std::size_t i = 0; i < 40; ++i) {
    flood.push_back(std::make_unique<RawClient>(port(), RawClient::Options{.from = "127.0.0.2"}));
    const std::size_t silent = std::min<std::size_t>(i + 2, 4);
    ASSERT_TRUE(until([&] { return server().session_count() == silent; }));
  }
  greet(slow);
}

TEST_F(Limited, EachHonestHelloIsAnsweredAmongSilentConnections) {
  options.limits.hello_deadline = milliseconds(10'000);
  options.limits.accepts_per_second = 1e6;
  std::vector<std::unique_ptr<RawClient>> flood, good;
  for (int i = 0; i < 60; ++i) {
    for (int silent = 0; silent < 5; ++silent) flood.push_back(std::make_unique<RawClient>(port()));
    good.push_back(std::make_unique<RawClient>(port()));
    greet(*good.back());
  }
  EXPECT_EQ(handler.sessions.size(), 60u);
}

TEST_F(Limited, AnAddressThatConnectsTooOftenKeepsNoOtherWaiting) {
  options.limits.hello_deadline = milliseconds(10'000);
  options.limits.max_unauthenticated = 1000;
  options.limits.accepts_per_second = 20;
  server();
  std::vector<std::unique_ptr<RawClient>> flood;
  for (int i = 0; i < 120; ++i)
    flood.push_back(std::make_unique<RawClient>(port(), RawClient::Options{.from = "127.0.0.2"}));
  RawClient good(port());
  greet(good);
  EXPECT_LT(server().session_count(), 110u) << "it did not wait for all that came before it";
}

TEST_F(Limited, AFloodOfRefusedClientsHoldsNoDescriptors) {
  options.limits.max_sessions = 1;
  options.limits.places_for_admins = 0;
  options.limits.accepts_per_second = 1e6;
  RawClient good(port());
  greet(good);
  std::vector<std::unique_ptr<RawClient>> flood;
  for (int i = 0; i < 200; ++i) flood.push_back(std::make_unique<RawClient>(port()));
  for (auto& client : flood) EXPECT_TRUE(until([&] { return client->reply() || client->closed(); }));
  EXPECT_EQ(server().session_count(), 1u);
  EXPECT_EQ(server().refused(), 200u);
  good.send(2, Status{});
  expect<Ok>(good);
}

TEST_F(Limited, AcceptingIsDelayedNotRefused) {
  options.limits.accepts_per_second = 20;
  std::vector<std::unique_ptr<RawClient>> clients;
  for (int i = 0; i < 24; ++i) clients.push_back(std::make_unique<RawClient>(port()));
  const auto began = std::chrono::steady_clock::now();
  for (auto& client : clients) {
    client->send_hello(Role::kObserver);
    expect<Welcome>(*client);
  }
  EXPECT_GE(std::chrono::steady_clock::now() - began, milliseconds(100));
}

TEST_F(Limited, EventsThatNobodyReadsEndTheSession) {
  options.limits.max_queued_replies = 50;
  RawClient client(port(), {.receive_buffer = 4096});
  Session& session = greet(client);
  std::int64_t sent = 0;
  EXPECT_TRUE(until([&] {
    for (int i = 0; i < 20 && handler.closed.empty(); ++i, ++sent)
      session.send(0, Event{"world_changed", std::string(10'000, 'x'), "", 1, sent});
    return !handler.closed.empty();
  }));
  EXPECT_EQ(handler.closed.at(0).reason, CloseReason::kLost);
}

TEST_F(Limited, AReplyLargerThanTheQueueIsStillSent) {
  RawClient client(port());
  Session& session = greet(client);
  const std::size_t large = 4 * options.limits.max_queued_bytes;
  session.send(2, BlackboardData{0, large, std::vector<std::byte>(large), 1});
  session.send(3, Ok{});
  EXPECT_EQ(expect<BlackboardData>(client).data.size(), large);
  expect<Ok>(client);
}

// For example replies to requests that waited behind another one.
TEST_F(Limited, RepliesThatComeTogetherEndNoSession) {
  options.limits.stall_deadline = milliseconds(10'000);
  RawClient client(port(), {.receive_buffer = 4096});
  Session& session = greet(client);
  const std::size_t large = 4 * options.limits.max_queued_bytes;
  for (std::uint64_t id = 2; id <= 5; ++id)
    session.send(id, BlackboardData{0, large, std::vector<std::byte>(large), 1});
  EXPECT_TRUE(session.behind());
  session.send(0, Event{"world_changed", "", "", 1, 1});
  EXPECT_EQ(handler.rooms, 0);
  for (int i = 2; i <= 5; ++i) EXPECT_EQ(expect<BlackboardData>(client).data.size(), large);
  EXPECT_EQ(expect<Event>(client).kind, "world_changed");
  EXPECT_TRUE(until([&] { return handler.rooms > 0; }));
  EXPECT_FALSE(session.behind());
  EXPECT_TRUE(handler.closed.empty());
}

TEST_F(Limited, AClientThatAsksButDoesNotReadIsNotAnsweredWithoutEnd) {
  options.limits.stall_deadline = milliseconds(10'000);
  handler.answer = [](Session& session, std::uint64_t id, const Request&) {
    session.send(id, BlackboardData{0, 0, std::vector<std::byte>(10'000), 1});
  };
  RawClient client(port(), {.receive_buffer = 4096});
  greet(client);
  std::vector<std::byte> stream;
  for (std::uint64_t id = 1; id <= 5000; ++id) encode_request(id, Read{"arm"}, stream);
  client.send(stream);
  std::size_t before = ~std::size_t{0};
  EXPECT_TRUE(until(
      [&] { return std::exchange(before, handler.asked.size()) == handler.asked.size() && before > 0; }));
  EXPECT_LT(handler.asked.size(), 1500u);
  EXPECT_TRUE(handler.closed.empty());
  std::size_t answered = 0;
  EXPECT_TRUE(until([&] {
    while (client.reply()) ++answered;
    return answered == handler.asked.size() && answered > before;
  }));
}

TEST_F(Limited, WithoutDescriptorsAcceptingWaitsAndGoesOn) {
  options.limits.hello_deadline = milliseconds(10'000);
  server();
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &limit), 0);
  RawClient first(port()), second(port());
  rlimit none = limit;
  none.rlim_cur = 3;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  for (int i = 0; i < 20; ++i) server().poll_for(milliseconds(1));
  EXPECT_EQ(server().session_count(), 0u);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);
  greet(first);
  greet(second);
}

}  // namespace
}  // namespace visum::protocol
