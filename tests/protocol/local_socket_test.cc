// Programs of one run meet on a Unix socket, and all others on TCP.
#include "protocol/local_socket.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>
#include <thread>

#include "protocol/client.h"
#include "protocol/client_socket.h"
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
  testing::NotingHandler handler_of_other;
  handler_of_other.answer = handler.answer;
  Server other(options, handler_of_other);
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

// A server of bytes on the socket beside `port`. It takes what comes late, and answers later still.
void answer_slowly(int listening, int exchanges) {
  constexpr std::chrono::milliseconds kPause{10};
  const int fd = ::accept(listening, nullptr, nullptr);
  std::array<std::byte, 64> bytes{};
  for (int i = 0; i < exchanges; ++i) {
    std::this_thread::sleep_for(kPause);
    EXPECT_GT(::recv(fd, bytes.data(), bytes.size(), 0), 0);
    std::this_thread::sleep_for(kPause);
    EXPECT_GT(::send(fd, bytes.data(), bytes.size(), 0), 0);
  }
  ::close(fd);
}

long sleeps_of_this_thread() {
  rusage use{};
  ::getrusage(RUSAGE_THREAD, &use);
  return use.ru_nvcsw;
}

TEST(LocalWait, EndsWithTheAnswerAndIsNotDisturbedBefore) {
  constexpr std::uint16_t kPort = 1;  // only a part of the name
  constexpr int kExchanges = 20;
  ::setenv(kLocalVariable, ("waits" + std::to_string(::getpid())).c_str(), 1);
  const int listening = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const LocalAddress name = local_address(local_socket_name(kPort));
  ASSERT_EQ(::bind(listening, reinterpret_cast<const sockaddr*>(&name.address), name.size), 0);
  ASSERT_EQ(::listen(listening, 1), 0);
  std::thread server(answer_slowly, listening, kExchanges);
  ClientSocket client("127.0.0.1", kPort, {}, kNever);
  std::array<std::byte, 64> bytes{};
  const long before = sleeps_of_this_thread();
  for (int i = 0; i < kExchanges; ++i) {
    EXPECT_EQ(client.send(bytes), bytes.size());
    EXPECT_EQ(client.receive(bytes, kNever), bytes.size());
  }
  EXPECT_LT(sleeps_of_this_thread() - before, kExchanges + 8);  // 40 where taking a message wakes its sender
  server.join();
  EXPECT_THROW(client.receive(bytes, kNever), ConnectionError);
  ::close(listening);
  ::unsetenv(kLocalVariable);
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
