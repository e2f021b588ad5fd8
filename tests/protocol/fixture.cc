#include "tests/protocol/fixture.h"

namespace visum::testing {

using namespace protocol;

Role NotingHandler::on_hello(Session& session, const Hello& hello, Welcome& welcome, Error& why) {
  if (at_hello) at_hello(session);
  if (refusal.code != ErrorCode::kUnspecified) {
    why = refusal;
    return Role::kUnspecified;
  }
  welcome.server = "test";
  sessions[session.id()] = &session;
  return hello.role;
}

void NotingHandler::on_request(Session& session, std::uint64_t id, const Request& request) {
  asked.push_back({session.id(), id, request});
  if (answer) return answer(session, id, request);
  session.send(id, Ok{});
}

void NotingHandler::on_close(Session& session, CloseReason reason) {
  sessions.erase(session.id());
  closed.push_back({session.id(), reason});
  if (at_close) at_close(session);
}

void NotingHandler::on_notify() {
  ++notified;
  if (at_notify) at_notify();
}

Server& ServerTest::server() {
  if (!server_) {
    server_ = std::make_unique<Server>(options, handler);
    server_->start();
  }
  return *server_;
}

bool ServerTest::until(const std::function<bool()>& is_true) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!is_true()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    server().poll_for(std::chrono::milliseconds(1));
  }
  return true;
}

ReplyFrame ServerTest::next(RawClient& client) {
  std::optional<ReplyFrame> frame;
  if (!until([&] { return (frame = client.reply()).has_value(); })) {
    ADD_FAILURE() << "no reply came";
    return {};
  }
  return std::move(*frame);
}

Session& ServerTest::greet(RawClient& client, Role role, const std::string& name) {
  client.send_hello(role, name);
  return *handler.sessions.at(expect<Welcome>(client).session);
}

Error ServerTest::expect_refusal(RawClient& client) {
  Error error = expect<Error>(client);
  expect_closed(client);
  return error;
}

void ServerTest::expect_closed(RawClient& client) {
  EXPECT_TRUE(until([&] { return client.closed(); })) << "the server did not close the connection";
}

}  // namespace visum::testing
