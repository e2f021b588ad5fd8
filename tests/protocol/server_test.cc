// The server as its owner and its clients see it: hello, requests, samples, threads, closing.
#include <gmock/gmock.h>

#include <filesystem>
#include <thread>

#include "tests/protocol/fixture.h"

namespace visum::protocol {
namespace {

using ::testing::HasSubstr;
using testing::RawClient;

class Serving : public testing::ServerTest {};

// ---------------------------------------- hello

TEST_F(Serving, WelcomeTellsVersionSessionAndRole) {
  RawClient client(port());
  client.send_hello(Role::kObserver);
  const ReplyFrame frame = next(client);
  const auto& welcome = std::get<Welcome>(frame.reply);
  EXPECT_EQ(frame.reply_to, 1u);
  EXPECT_EQ(welcome.version, kProtocolVersion);
  EXPECT_EQ(welcome.role, Role::kObserver);
  EXPECT_EQ(welcome.server, "test");
  EXPECT_NE(welcome.session, 0u);
  EXPECT_EQ(server().session_count(), 1u);
}

TEST_F(Serving, SessionKnowsItsClient) {
  RawClient client(port());
  Session& session = greet(client, Role::kAdmin, "panel");
  EXPECT_EQ(session.client_name(), "panel");
  EXPECT_EQ(session.role(), Role::kAdmin);
  EXPECT_THAT(session.peer(), ::testing::StartsWith("127.0.0.1:"));
}

TEST_F(Serving, ANamelessClientIsKnownByItsAddress) {
  RawClient client(port());
  Session& session = greet(client, Role::kObserver, "");
  EXPECT_EQ(session.client_name(), session.peer());
}

TEST_F(Serving, TheFirstMessageMustBeHello) {
  RawClient client(port());
  client.send(5, Status{});
  const Error error = expect_refusal(client);
  EXPECT_EQ(error.code, ErrorCode::kMalformed);
  EXPECT_EQ(error.text, "the first message must be Hello");
  EXPECT_TRUE(handler.asked.empty());
  EXPECT_TRUE(handler.closed.empty()) << "it never was a session of the handler's";
  EXPECT_EQ(server().refused(), 1u);
}

TEST_F(Serving, ASecondHelloEndsTheSession) {
  RawClient client(port());
  greet(client);
  client.send_hello(Role::kAdmin);
  EXPECT_EQ(expect_refusal(client).text, "a second Hello");
  ASSERT_EQ(handler.closed.size(), 1u);
  EXPECT_EQ(handler.closed[0].reason, CloseReason::kRefused);
}

TEST_F(Serving, VersionsWithoutOneInCommonGetAReadableRefusal) {
  RawClient client(port());
  client.send(1, Hello{7, 9, "from the future", Role::kObserver, ""});
  const Error error = expect_refusal(client);
  EXPECT_EQ(error.code, ErrorCode::kVersion);
  EXPECT_THAT(error.text, HasSubstr("the client 7 to 9"));
}

TEST_F(Serving, TheHandlersRefusalReachesTheClient) {
  handler.refusal = {ErrorCode::kForbidden, "observers only", ""};
  RawClient client(port());
  client.send_hello(Role::kAdmin);
  const Error error = expect_refusal(client);
  EXPECT_EQ(error.code, ErrorCode::kForbidden);
  EXPECT_EQ(error.text, "observers only");
}

TEST_F(Serving, SpeaksIpv6) {
  options.address = "::1";
  RawClient client(port(), {.address = "::1"});
  EXPECT_THAT(greet(client).peer(), ::testing::StartsWith("[::1]:"));
}

TEST_F(Serving, ABadAddressIsNamed) {
  options.address = "256.0.0.1";
  try {
    server();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("256.0.0.1"));
  }
}

TEST_F(Serving, APortInUseIsNamed) {
  testing::NotingHandler other;
  try {
    ListenOptions same = options;
    same.port = port();
    Server second(same, other);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("127.0.0.1:" + std::to_string(port())));
  }
}

// ---------------------------------------- requests

TEST_F(Serving, AnswersInOrderHoweverTheBytesCome) {
  RawClient client(port());
  greet(client);
  std::vector<std::byte> stream;
  for (std::uint64_t id = 10; id < 15; ++id) encode_request(id, Write{"arm", 0, {1.0, 2.0}, id}, stream);
  for (const std::byte& byte : stream) {
    ASSERT_EQ(client.send(std::span(&byte, 1)), 1u);
    server().poll();
  }
  for (std::uint64_t id = 10; id < 15; ++id) EXPECT_EQ(next(client).reply_to, id);
  EXPECT_EQ(std::get<Write>(handler.asked[4].request).sequence, 14u);
}

TEST_F(Serving, ThousandsOfRequestsAtOnceAreAllAnswered) {
  RawClient client(port());
  greet(client);
  std::vector<std::byte> stream;
  for (std::uint64_t id = 1; id <= 20'000; ++id) encode_request(id, Read{"arm"}, stream);
  std::span<const std::byte> left(stream);
  std::uint64_t answered = 0;
  ASSERT_TRUE(until([&] {
    if (!left.empty()) left = left.subspan(client.send(left));
    while (const auto frame = client.reply()) EXPECT_EQ(frame->reply_to, ++answered);
    return answered == 20'000;
  }));
}

TEST_F(Serving, AFloodingClientDoesNotHoldPoll) {
  RawClient flooder(port()), other(port());
  greet(flooder);
  greet(other);
  std::vector<std::byte> stream;
  for (std::uint64_t id = 1; id <= 20'000; ++id) encode_request(id, Status{}, stream);
  flooder.send(stream);
  server().poll();
  const std::size_t before = handler.asked.size();
  EXPECT_LT(before, 20'000u) << "one poll() took all of it";
  other.send(7, Status{});
  EXPECT_EQ(next(other).reply_to, 7u);
}

TEST_F(Serving, BytesThatAreNoMessageEndTheSessionWithAReason) {
  RawClient client(port());
  greet(client);
  client.send(testing::header_of(3));
  client.send(testing::header_of(0xFFFFFFFF));
  const Error error = expect_refusal(client);
  EXPECT_EQ(error.code, ErrorCode::kMalformed);
  EXPECT_EQ(handler.closed.at(0).reason, CloseReason::kRefused);
}

TEST_F(Serving, AThrowingHandlerCostsOnlyThatSession) {
  handler.answer = [](Session& session, std::uint64_t id, const Request& request) {
    if (std::holds_alternative<Reset>(request)) throw std::runtime_error("boom");
    session.send(id, Ok{});
  };
  RawClient bad(port()), good(port());
  greet(bad);
  greet(good);
  bad.send(4, Reset{});
  EXPECT_EQ(expect_refusal(bad).code, ErrorCode::kInternal);
  good.send(5, Status{});
  expect<Ok>(good);
}

TEST_F(Serving, ARequestThatThereIsNoMemoryForIsRefusedAndItsSessionStays) {
  handler.answer = [](Session& session, std::uint64_t id, const Request& request) {
    if (std::holds_alternative<Reset>(request)) throw std::bad_alloc();
    session.send(id, Ok{});
  };
  RawClient client(port());
  greet(client);
  client.send(4, Reset{});
  const auto error = expect<Error>(client);
  EXPECT_EQ(error.code, ErrorCode::kBusy);
  EXPECT_THAT(error.text, HasSubstr("not enough memory"));
  client.send(5, Status{});
  expect<Ok>(client);
}

TEST_F(Serving, AThrowingNotificationCostsNothing) {
  handler.at_notify = [] { throw 42; };
  server().notify();
  EXPECT_TRUE(until([&] { return handler.notified == 1; }));
  RawClient client(port());
  greet(client);
}

// ---------------------------------------- samples

TEST_F(Serving, SamplesOfOneTickComeBeforeTheReplyToIt) {
  RawClient client(port());
  Session& session = greet(client);
  session.send(9, Advanced{5, 5'000'000, 1});
  EXPECT_TRUE(session.ready_for(1));
  EXPECT_TRUE(session.send_latest(1, PartSample{"arm", 4, 0, 1, {}, {}, 0}));
  EXPECT_FALSE(session.ready_for(1));
  EXPECT_FALSE(session.send_latest(1, PartSample{"arm", 5, 0, 1, {}, {}, 0}));
  EXPECT_EQ(expect<PartSample>(client).tick, 5);
  EXPECT_EQ(expect<Advanced>(client).tick, 5);
}

TEST_F(Serving, ASlowReaderGetsTheNewestSampleOnceItReads) {
  RawClient slow(port(), {.receive_buffer = 4096});
  Session& session = greet(slow);
  const std::vector<double> many(2000, 1.0);
  bool conflated = false;
  std::int64_t tick = 0;
  while (!conflated) {
    conflated = !session.send_latest(1, PartSample{"arm", ++tick, 0, 1, many, {}, 0});
    if (tick % 2 == 0) server().poll();
    ASSERT_LT(tick, 100'000);
  }
  std::int64_t last = 0;
  ASSERT_TRUE(until([&] {
    while (const auto frame = slow.reply()) {
      const std::int64_t got = std::get<PartSample>(frame->reply).tick;
      EXPECT_GT(got, last);
      last = got;
    }
    return last == tick;
  }));
}

// ---------------------------------------- closing

TEST_F(Serving, AFinBetweenFramesIsGoodbye) {
  RawClient client(port());
  greet(client);
  client.finish_sending();
  EXPECT_TRUE(until([&] { return !handler.closed.empty(); }));
  EXPECT_EQ(handler.closed[0].reason, CloseReason::kGoodbye);
  EXPECT_EQ(server().session_count(), 0u);
}

TEST_F(Serving, AFinInsideAFrameIsALoss) {
  RawClient client(port());
  greet(client);
  client.send(testing::header_of(20));
  client.finish_sending();
  EXPECT_TRUE(until([&] { return !handler.closed.empty(); }));
  EXPECT_EQ(handler.closed[0].reason, CloseReason::kLost);
}

TEST_F(Serving, AResetIsALoss) {
  RawClient client(port());
  greet(client);
  client.reset();
  EXPECT_TRUE(until([&] { return !handler.closed.empty(); }));
  EXPECT_EQ(handler.closed[0].reason, CloseReason::kLost);
}

TEST_F(Serving, RequestsBeforeAFinAreStillAnswered) {
  RawClient client(port());
  greet(client);
  client.send(8, Status{});
  client.finish_sending();
  EXPECT_EQ(next(client).reply_to, 8u);
  expect_closed(client);
}

TEST_F(Serving, AHandlerMayCloseASessionFromWithinARequest) {
  handler.answer = [](Session& session, std::uint64_t id, const Request&) {
    session.send(id, Ok{});
    session.close(CloseReason::kRefused);
    session.send(id, Ok{});  // too late, so it is ignored
  };
  RawClient client(port());
  greet(client);
  client.send(2, Status{});
  client.send(3, Status{});
  expect<Ok>(client);
  expect_closed(client);
  EXPECT_EQ(handler.asked.size(), 1u);
  ASSERT_EQ(handler.closed.size(), 1u);
  EXPECT_EQ(handler.closed[0].reason, CloseReason::kRefused);
}

TEST_F(Serving, OthersMayBeToldWhenASessionCloses) {
  RawClient leaving(port()), staying(port());
  greet(leaving);
  Session& other = greet(staying);
  handler.at_close = [&](Session&) { other.send(0, Event{"lease_lost", "", "arm", 1, 2}); };
  leaving.reset();
  EXPECT_EQ(expect<Event>(staying).kind, "lease_lost");
}

TEST_F(Serving, StopWritesWhatIsQueuedThenCloses) {
  RawClient client(port());
  Session& session = greet(client);
  for (std::uint64_t id = 1; id <= 100; ++id) session.send(id, Ok{});
  server().stop();
  server().run();
  EXPECT_EQ(handler.closed.at(0).reason, CloseReason::kShutdown);
  for (std::uint64_t id = 1; id <= 100; ++id) EXPECT_EQ(next(client).reply_to, id);
  EXPECT_TRUE(client.closed());
}

TEST_F(Serving, DestroyedInTheMiddleOfEverythingItLeavesNothingBehind) {
  RawClient silent(port()), half(port()), blocked(port(), {.receive_buffer = 4096});
  greet(half);
  half.send(testing::header_of(20));
  Session& session = greet(blocked);
  for (int i = 0; i < 100; ++i)
    session.send_latest(1, PartSample{"arm", i, 0, 1, std::vector<double>(10'000), {}, 0}), server().poll();
  stop();
  EXPECT_TRUE(silent.closed());
  EXPECT_TRUE(half.closed());
}

std::size_t open_descriptors() {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}));
}

TEST_F(Serving, AThousandConnectionsLeaveNoDescriptorBehind) {
  options.limits.accepts_per_second = 1e6;
  server();
  const std::size_t before = open_descriptors();
  for (int i = 0; i < 1000; ++i) {
    RawClient client(port());
    if (i % 3 == 0) client.send_hello(Role::kObserver);
    if (i % 3 == 1) client.reset();
    server().poll();
  }
  EXPECT_TRUE(until([&] { return open_descriptors() == before && server().session_count() == 0; }))
      << open_descriptors() << " descriptors, before: " << before;
}

// ---------------------------------------- threads

TEST_F(Serving, NotificationsFromAnotherThreadArriveOnTheServersOwn) {
  std::thread::id seen;
  handler.at_notify = [&] { seen = std::this_thread::get_id(); };
  std::thread other([&, &server = server()] { server.notify(); });
  EXPECT_TRUE(until([&] { return handler.notified > 0; }));
  other.join();
  EXPECT_EQ(seen, std::this_thread::get_id());
}

TEST_F(Serving, ManyNotificationsMayArriveAsOneButNeverAsNone) {
  for (int round = 1; round <= 50; ++round) {
    for (int i = 0; i < 10; ++i) server().notify();
    ASSERT_TRUE(until([&] { return handler.notified >= round; }));
  }
}

TEST_F(Serving, StopFromAnotherThreadEndsRun) {
  Server& running = server();
  std::thread other([&] { running.stop(); });
  running.run();
  other.join();
}

TEST_F(Serving, PollWithNothingReadyReturnsAtOnce) {
  server().poll();
  EXPECT_FALSE(server().poll());
}

}  // namespace
}  // namespace visum::protocol
