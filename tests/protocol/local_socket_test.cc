// Programs of one run meet on a Unix socket, and all others on TCP.
#include "protocol/local_socket.h"

#include <gmock/gmock.h>
#include <sys/socket.h>

#include <cstdlib>
#include <string>
#include <thread>

#include "protocol/client.h"
#include "tests/protocol/fixture.h"

namespace visum::protocol {
namespace {

using ::testing::MatchesRegex;
using ::testing::StartsWith;

const Hello kHello{1, kProtocolVersion, "tester", Role::kController, ""};

class LocalSocket : public ::testing::Test {
 protected:
  LocalSocket() {
    handler.answer = [this](Session& session, std::uint64_t id, const Request&) {
      peer = session.peer();
      session.send(id, Ok{});
    };
    options.port = 0;
    options.limits.max_sessions_per_local_peer = 2;
    ::setenv(kLocalVariable, "tested", 1);
  }
  ~LocalSocket() override {
    ::unsetenv(kLocalVariable);
    if (server) end();
  }
  void serve() {
    server = std::make_unique<Server>(options, handler);
    server->start();
    thread = std::thread([this] { server->run(); });
  }
  // At a port below those that the kernel hands out to others meanwhile, so that it can be had again.
  void serve_at_a_port_of_ours() {
    for (int port = 20'000; !server && port < 30'000; ++port) try {
        options.port = static_cast<std::uint16_t>(port);
        serve();
      } catch (const std::runtime_error&) {  // it is taken
      }
    ASSERT_TRUE(server);
  }
  void end() {
    server->stop();
    thread.join();
    server.reset();
  }
  Connection connect() { return Connection("127.0.0.1", server->port(), kHello, std::chrono::seconds(10)); }
  // Where a new client comes from, as the server sees it.
  std::string seen() {
    connect().request_as<Ok>(Status{});
    return peer;
  }

  testing::NotingHandler handler;
  ListenOptions options;
  std::unique_ptr<Server> server;
  std::thread thread;
  std::string peer;
};

TEST_F(LocalSocket, IsUsedWhereBothEndsHaveTheWord) {
  serve();
  EXPECT_EQ(seen(), "a Unix socket");
}

TEST_F(LocalSocket, IsNotUsedWithoutTheWord) {
  serve();
  ::unsetenv(kLocalVariable);
  EXPECT_THAT(seen(), StartsWith("127.0.0.1:"));
  ::setenv(kLocalVariable, "another", 1);
  EXPECT_THAT(seen(), StartsWith("127.0.0.1:"));
}

TEST_F(LocalSocket, ClientsOfAServerWithoutItUseTcp) {
  ::unsetenv(kLocalVariable);
  serve();
  ::setenv(kLocalVariable, "tested", 1);
  EXPECT_THAT(seen(), StartsWith("127.0.0.1:"));
}

TEST_F(LocalSocket, ServersOfOtherAddressesHaveNone) {
  options.address = "::1";
  serve();
  Connection("::1", server->port(), kHello, std::chrono::seconds(10)).request_as<Ok>(Status{});
  EXPECT_THAT(peer, StartsWith("[::1]:"));
}

TEST_F(LocalSocket, AWordThatFitsIntoNoNameIsNotUsed) {
  ::setenv(kLocalVariable, std::string(200, 'x').c_str(), 1);
  serve();
  EXPECT_THAT(seen(), StartsWith("127.0.0.1:"));
}

TEST_F(LocalSocket, CountsAsAnAddressOfThisMachine) {
  serve();
  const auto first = connect();
  ::unsetenv(kLocalVariable);
  const auto second = connect();
  ::setenv(kLocalVariable, "tested", 1);
  EXPECT_THROW(connect(), RequestError) << "a third session from one address";
}

TEST_F(LocalSocket, ItsServersAreToldApartByTheirPorts) {
  serve();
  Server other(options, handler);
  other.start();
  std::thread others([&] { other.run(); });
  EXPECT_NE(local_socket_name(server->port()), local_socket_name(other.port()));
  EXPECT_EQ(seen(), "a Unix socket");
  Connection("127.0.0.1", other.port(), kHello, std::chrono::seconds(10)).request_as<Ok>(Status{});
  EXPECT_EQ(peer, "a Unix socket");
  other.stop();
  others.join();
}

TEST_F(LocalSocket, WhereTheNameIsTakenTheServerUsesTcp) {
  serve_at_a_port_of_ours();
  end();
  const int taken = ::socket(AF_UNIX, SOCK_STREAM, 0);
  const LocalAddress name = local_address(local_socket_name(options.port));
  ASSERT_EQ(::bind(taken, reinterpret_cast<const sockaddr*>(&name.address), name.size), 0);
  serve();
  EXPECT_THAT(seen(), StartsWith("127.0.0.1:"));
  ::close(taken);
}

TEST_F(LocalSocket, AServerThatHasEndedLeavesNothing) {
  serve_at_a_port_of_ours();
  end();
  serve();
  EXPECT_EQ(seen(), "a Unix socket");
}

TEST(LocalWord, IsKeptOrMadeAtRandom) {
  ::unsetenv(kLocalVariable);
  share_local_sockets();
  const std::string word = std::getenv(kLocalVariable);
  EXPECT_THAT(word, MatchesRegex("[0-9]+"));
  share_local_sockets();
  EXPECT_EQ(std::getenv(kLocalVariable), word);
  ::unsetenv(kLocalVariable);
  share_local_sockets();
  EXPECT_NE(std::getenv(kLocalVariable), word);
  ::unsetenv(kLocalVariable);
}

}  // namespace
}  // namespace visum::protocol
