// The client's end, against a real server on a thread of its own, and against servers that misbehave.
#include "protocol/client.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "protocol/client_inbox.h"
#include "tests/protocol/fixture.h"

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

const Hello kHello{1, kProtocolVersion, "tester", Role::kController, ""};

class Client : public ::testing::Test {
 protected:
  Client() {
    handler.answer = [this](Session& session, std::uint64_t id, const Request& request) {
      answer(session, id, request);
    };
    options.port = 0;
  }
  ~Client() override {
    if (!server) return;
    server->stop();
    thread.join();
  }
  Connection connect(milliseconds timeout = std::chrono::seconds(10)) {
    if (!server) {
      server = std::make_unique<Server>(options, handler);
      server->start();
      thread = std::thread([this] { server->run(); });
    }
    return Connection(options.address, server->port(), kHello, timeout);
  }

  // A little world. Write is refused, Read sends a sample before its answer, Join is never answered, Advance
  // is answered only when Leave comes, and Shutdown closes the session.
  void answer(Session& session, std::uint64_t id, const Request& request) {
    if (std::holds_alternative<Write>(request)) {
      session.send(id, Error{ErrorCode::kNoLease, "leased by panel", "panel"});
    } else if (std::holds_alternative<Read>(request)) {
      for (std::int64_t i = 0; i < samples; ++i) session.send(0, PartSample{"arm", i, 0, 1, {}, {}, 0});
      session.send(id, Ok{});
    } else if (std::holds_alternative<Advance>(request)) {
      advance_id = id;
    } else if (std::holds_alternative<Leave>(request)) {
      session.send(advance_id, Advanced{7, 7, 1});
      session.send(id, Ok{});
    } else if (std::holds_alternative<Shutdown>(request)) {
      session.send(0, Error{ErrorCode::kInternal, "going down", ""});
      session.close(CloseReason::kRefused);
    } else if (!std::holds_alternative<Join>(request)) {
      if (id != 0) session.send(id, Ok{});
    }
  }

  testing::NotingHandler handler;
  ListenOptions options;
  std::unique_ptr<Server> server;
  std::thread thread;
  std::int64_t samples = 1;
  std::uint64_t advance_id = 0;
};

// Probes find a silent peer only while no data waits for an acknowledgement. While some does, the time
// without an acknowledgement counts.
TEST_F(Client, AsksTheKernelToNoticeAServerThatVanishedWhileItIsSpokenTo) {
  const auto connection = connect();
  const auto option = [&](int level, int name) {
    int value = 0;
    socklen_t size = sizeof value;
    EXPECT_EQ(::getsockopt(connection.native_handle(), level, name, &value, &size), 0);
    return value;
  };
  EXPECT_EQ(option(SOL_SOCKET, SO_KEEPALIVE), 1);
  EXPECT_EQ(option(IPPROTO_TCP, TCP_USER_TIMEOUT), 4000);
}

TEST_F(Client, IsWelcomed) {
  Connection connection = connect();
  EXPECT_EQ(connection.welcome().server, "test");
  EXPECT_EQ(connection.welcome().role, Role::kController);
}

TEST_F(Client, SpeaksIpv6) {
  options.address = "::1";
  Connection connection = connect();
  connection.request_as<Ok>(Status{});
}

TEST_F(Client, FindsLocalhostByName) {
  connect();
  Connection by_name("localhost", server->port(), kHello);
  by_name.request_as<Ok>(Status{});
}

TEST_F(Client, ARefusalCarriesCodeTextAndOwner) {
  Connection connection = connect();
  try {
    connection.request(Write{"arm", 0, {1.0}, 0});
    FAIL();
  } catch (const RequestError& error) {
    EXPECT_EQ(error.code(), ErrorCode::kNoLease);
    EXPECT_STREQ(error.what(), "leased by panel");
    EXPECT_EQ(error.owner(), "panel");
  }
  connection.request_as<Ok>(Status{});
}

TEST_F(Client, WhatIsSentAlongLeavesWithTheNextRequestOrOnceItIsWaitedFor) {
  Connection connection = connect();
  const auto along = connection.send_along(Status{});
  connection.request_as<Ok>(Status{});
  EXPECT_TRUE(connection.wait_for(along, milliseconds(0))) << "it came before";
  EXPECT_TRUE(std::holds_alternative<Ok>(connection.wait(connection.send_along(Status{}))));
}

TEST_F(Client, WhatIsSentAlongLeavesBeforeTheConnectionEnds) {
  {
    Connection connection = connect();
    connection.send_along(Status{});
  }
  server->stop();
  thread.join();
  server.reset();
  EXPECT_EQ(handler.asked.size(), 1u);
}

TEST_F(Client, AnAnswerOfAnotherKindIsAnError) {
  Connection connection = connect();
  EXPECT_THROW(connection.request_as<PartList>(Status{}), RequestError);
}

TEST_F(Client, KeepsSamplesThatComeBeforeAnAnswer) {
  Connection connection = connect();
  connection.request_as<Ok>(Read{"arm"});
  const auto sample = connection.next(milliseconds(0));
  ASSERT_TRUE(sample);
  EXPECT_EQ(std::get<PartSample>(*sample).part, "arm");
  EXPECT_FALSE(connection.next(milliseconds(0)));
}

TEST_F(Client, KeepsOnlyTheNewestSampleAndCountsTheOthers) {
  samples = 5;
  Connection connection = connect();
  connection.request_as<Ok>(Read{"arm"});
  const auto sample = connection.next(milliseconds(0));
  ASSERT_TRUE(sample);
  EXPECT_EQ(std::get<PartSample>(*sample).tick, 4);
  EXPECT_EQ(std::get<PartSample>(*sample).conflated, 4u);
  EXPECT_FALSE(connection.next(milliseconds(0)));
}

TEST_F(Client, ARefusedPostArrivesAmongTheEvents) {
  Connection connection = connect();
  connection.post(Write{"arm", 0, {1.0}, 0});
  const auto event = connection.next(std::chrono::seconds(10));
  ASSERT_TRUE(event);
  EXPECT_EQ(std::get<Error>(*event).text, "leased by panel");
}

TEST_F(Client, SeveralRequestsMayBeInFlight) {
  Connection connection = connect();
  const auto advance = connection.send(Advance{1});
  const auto status = connection.send(Status{});
  EXPECT_TRUE(std::holds_alternative<Ok>(connection.wait(status)));
  const auto leave = connection.send(Leave{});
  EXPECT_EQ(std::get<Advanced>(connection.wait(advance)).tick, 7);
  EXPECT_TRUE(std::holds_alternative<Ok>(connection.wait(leave)));
  EXPECT_THROW(connection.wait(leave), std::invalid_argument);
}

TEST_F(Client, WithoutAnAnswerARequestTimesOutAndTheNextStillWorks) {
  Connection connection = connect(milliseconds(1500));
  try {
    connection.request(Join{});
    FAIL();
  } catch (const RequestError& error) {
    EXPECT_EQ(error.code(), ErrorCode::kTimeout);
  }
  connection.request_as<Ok>(Status{});
}

TEST_F(Client, WaitsForTheWorldWithoutALimit) {
  Connection connection = connect(milliseconds(1000));  // the greeting has this limit, too
  const auto advance = connection.send(Advance{1});
  EXPECT_FALSE(connection.next(milliseconds(1200)));
  connection.send(Leave{});
  EXPECT_EQ(std::get<Advanced>(connection.wait(advance)).tick, 7);
}

TEST_F(Client, LearnsWhyTheServerHungUp) {
  Connection connection = connect();
  try {
    connection.request(Shutdown{});
    FAIL();
  } catch (const ConnectionError& error) {
    EXPECT_THAT(error.what(), HasSubstr("closed the connection: going down"));
  }
}

TEST_F(Client, ARefusalBeforeHelloIsARefusal) {
  options.limits.max_sessions = options.limits.places_for_admins = 0;
  try {
    connect();
    FAIL();
  } catch (const RequestError& error) {
    EXPECT_EQ(error.code(), ErrorCode::kBusy);
  }
}

TEST_F(Client, MayBeMoved) {
  Connection first = connect();
  Connection second = std::move(first);
  second.request_as<Ok>(Status{});
}

TEST_F(Client, SendsMoreThanTheSocketsHoldWithoutDeadlock) {
  Connection connection = connect();
  std::vector<std::uint64_t> ids;
  for (int i = 0; i < 3000; ++i) ids.push_back(connection.send(Subscribe{std::string(5000, 'x'), 1}));
  for (const auto id : ids) EXPECT_TRUE(std::holds_alternative<Ok>(connection.wait(id)));
}

// ---------------------------------------- other servers

// Listens on a free loopback port and sends a given text to its first client.
class Impostor {
 public:
  explicit Impostor(std::string says) : says_(std::move(says)) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{AF_INET, 0, {htonl(INADDR_LOOPBACK)}, {}};
    socklen_t size = sizeof address;
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(listener_, 1) != 0 ||
        ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("cannot listen");
    port = ntohs(address.sin_port);
  }
  ~Impostor() { ::close(listener_); }

  void serve_one() {
    const int client = ::accept(listener_, nullptr, nullptr);
    char request[1024];
    if (::recv(client, request, sizeof request, 0) > 0)
      ::send(client, says_.data(), says_.size(), MSG_NOSIGNAL);
    ::close(client);
  }
  std::uint16_t port = 0;

 private:
  std::string says_;
  int listener_;
};

std::string what_connecting_says(const std::string& answer) {
  Impostor impostor(answer);
  std::thread thread([&] { impostor.serve_one(); });
  std::string what;
  try {
    Connection connection("127.0.0.1", impostor.port, kHello, std::chrono::seconds(10));
  } catch (const ConnectionError& error) {
    what = error.what();
  }
  thread.join();
  return what;
}

TEST(ClientAlone, SaysThatNothingListens) {
  std::uint16_t port = 0;
  { port = Impostor("").port; }
  try {
    Connection connection("127.0.0.1", port, kHello);
    FAIL();
  } catch (const ConnectionError& error) {
    EXPECT_EQ(error.what(), "nothing listens at 127.0.0.1:" + std::to_string(port) + " (is visumd running?)");
  }
}

TEST(ClientAlone, SaysThatTheHostIsUnknown) {
  try {
    Connection connection("no such host", 1500, kHello);
    FAIL();
  } catch (const ConnectionError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot find the host 'no such host'"));
  }
}

TEST(ClientAlone, SaysThatTheServerIsNoVisum) {
  EXPECT_THAT(what_connecting_says("HTTP/1.1 400 Bad Request\r\n"), HasSubstr("is this Visum?"));
  EXPECT_THAT(what_connecting_says(std::string("\x02\x00\x00\x00\xFF\xFF", 6)), HasSubstr("is not a reply"));
  EXPECT_THAT(what_connecting_says(""), HasSubstr("the server closed the connection"));
}

TEST(ClientAlone, ASilentServerTimesOut) {
  Impostor impostor("");  // the kernel accepts the connection for it
  EXPECT_THROW(Connection("127.0.0.1", impostor.port, kHello, milliseconds(30)), RequestError);
}

// ---------------------------------------- pieces

TEST(ClientInbox, KeepsTheNewestEvents) {
  ClientInbox inbox;
  for (std::int64_t i = 0; i < 2000; ++i) inbox.put({0, Event{"e", "", "", 1, i}});
  std::size_t count = 0;
  for (auto reply = inbox.take_next(); reply; reply = inbox.take_next(), ++count)
    EXPECT_EQ(std::get<Event>(*reply).tick, static_cast<std::int64_t>(2000 - kMaxKeptEvents + count));
  EXPECT_EQ(count, kMaxKeptEvents);
}

TEST(ClientInbox, DropsAnswersThatNobodyWaitsFor) {
  ClientInbox inbox;
  inbox.expect(4, false);
  inbox.forget(4);
  inbox.put({4, Ok{}});
  EXPECT_FALSE(inbox.take_reply(4));
  EXPECT_FALSE(inbox.take_next());
}

TEST(ClientInbox, FindsEachReplyInWhateverOrderTheyAreTaken) {
  ClientInbox inbox;
  for (std::uint64_t id = 1; id <= 200; ++id) inbox.expect(id, id % 2 == 0);
  inbox.forget(100);
  for (std::uint64_t id = 1; id <= 200; ++id) inbox.put({id, Ok{static_cast<std::int64_t>(id)}});
  EXPECT_TRUE(inbox.unbounded(2));
  EXPECT_FALSE(inbox.take_reply(100));
  for (const std::uint64_t id : {150u, 1u, 2u, 200u}) {
    const auto reply = inbox.take_reply(id);
    ASSERT_TRUE(reply);
    EXPECT_EQ(std::get<Ok>(*reply).acts_at_tick, static_cast<std::int64_t>(id));
    EXPECT_FALSE(inbox.take_reply(id)) << "taken once";
  }
}

TEST(ParseAddress, UnderstandsTheThreeForms) {
  using Pair = std::pair<std::string, std::uint16_t>;
  EXPECT_EQ(parse_address("lab:1500"), Pair("lab", 1500));
  EXPECT_EQ(parse_address("[::1]:7"), Pair("::1", 7));
  EXPECT_EQ(parse_address("1501"), Pair("127.0.0.1", 1501));
}

TEST(ParseAddress, SaysWhatIsWrong) {
  for (const char* bad : {"", "lab", "lab:", ":1500", "lab:0", "lab:65536", "lab:15x", "::1:1500", "[]:1500",
                          "[::1]1500", "-1"})
    EXPECT_THROW(parse_address(bad), std::invalid_argument) << bad;
  try {
    parse_address("lab:99999");
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "'lab:99999' is not HOST:PORT, [IPV6]:PORT or PORT: the port is a number from 1 to 65535");
  }
}

}  // namespace
}  // namespace visum::protocol
