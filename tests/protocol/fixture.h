// A server on a free loopback port in the test's own thread. Its handler notes every call and answers as the
// test says. Nothing sleeps: until() serves until a condition is true.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "protocol/server.h"
#include "tests/protocol/raw_client.h"

namespace visum::testing {

struct NotingHandler : protocol::SessionHandler {
  struct Asked {
    std::uint64_t session, id;
    protocol::Request request;
  };
  struct Closed {
    std::uint64_t session;
    protocol::CloseReason reason;
  };

  protocol::Role on_hello(protocol::Session& session, const protocol::Hello& hello,
                          protocol::Welcome& welcome, protocol::Error& refusal) override;
  void on_request(protocol::Session& session, std::uint64_t id, const protocol::Request& request) override;
  void on_close(protocol::Session& session, protocol::CloseReason reason) override;
  void on_notify() override;
  void on_room(protocol::Session&) override { ++rooms; }

  // The test may set these: the answer to a request (default: Ok), and the reason to refuse a hello.
  std::function<void(protocol::Session&, std::uint64_t id, const protocol::Request&)> answer;
  std::function<void(protocol::Session&)> at_hello;
  std::function<void()> at_notify;
  std::function<void(protocol::Session&)> at_close;
  protocol::Error refusal;

  std::map<std::uint64_t, protocol::Session*> sessions;  // welcomed and not closed
  std::vector<Asked> asked;
  std::vector<Closed> closed;
  int notified = 0, rooms = 0;
};

class ServerTest : public ::testing::Test {
 protected:
  // The server starts with these options when it is first used.
  ServerTest() { options.port = 0; }
  protocol::Server& server();
  std::uint16_t port() { return server().port(); }

  // Serves until the condition is true. Returns false if it was not true within 10 s.
  bool until(const std::function<bool()>& is_true);

  // The next reply to the client, of any kind or of the type T. The test fails if none comes.
  protocol::ReplyFrame next(RawClient& client);
  template <typename T>
  T expect(RawClient& client) {
    const protocol::ReplyFrame frame = next(client);
    const T* value = std::get_if<T>(&frame.reply);
    if (!value) ADD_FAILURE() << "a reply of another kind: " << frame.reply.index();
    return value ? *value : T{};
  }
  // Says hello, reads the welcome, and returns the server's session.
  protocol::Session& greet(RawClient& client, protocol::Role role = protocol::Role::kController,
                           const std::string& name = "tester");
  // The error with which the server closes the connection.
  protocol::Error expect_refusal(RawClient& client);
  void expect_closed(RawClient& client);

  NotingHandler handler;
  protocol::ListenOptions options;

  void stop() { server_.reset(); }

 private:
  std::unique_ptr<protocol::Server> server_;
};

}  // namespace visum::testing
