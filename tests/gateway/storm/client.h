// A client in a storm: asks for whatever comes to its mind, some of it wrong, over connections that it loses,
// clogs and cuts; and checks what a client may rely on.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "protocol/messages.h"
#include "tests/gateway/storm/dice.h"
#include "tests/gateway/storm/wire.h"

namespace visum::storm {

class Client {
 public:
  using Expect = std::function<void(bool holds, const std::string& claim)>;
  Client(Dice& dice, int number, const protocol::PartDescription& part, Expect expect);

  // A connection that the server is to accept, where it wants a new one; else null.
  std::shared_ptr<Connection> wants_connection();
  void turn(std::int64_t now_ms);
  void leave();  // for good
  void server_died() { drop(); }

 private:
  void drop();
  void hear(std::int64_t now_ms);
  void understand(const protocol::Reply& reply, std::uint64_t reply_to);
  void follow_time(int kind, std::uint64_t era, std::int64_t tick);
  void say(std::int64_t now_ms);
  void misbehave(std::int64_t now_ms);
  protocol::Request any_request();
  protocol::Request about_part();
  protocol::Request about_events();
  protocol::Request about_time();
  protocol::Request a_write();
  void ask(const protocol::Request& request);
  void send(std::int64_t now_ms);

  Dice& dice_;
  const std::string name_;
  const protocol::Role role_;
  const protocol::PartDescription& part_;
  const Expect expect_;
  std::shared_ptr<Connection> connection_;
  std::vector<std::byte> unsent_, unread_;
  std::uint64_t next_id_ = 1;
  std::uint64_t sequence_ = 1;
  std::size_t chattiness_ = 1;  // ms between two requests, about
  bool silent_ = false;         // a client that died where nobody noticed
  bool gone_ = false;
  std::map<int, std::tuple<std::uint64_t, std::int64_t>> seen_;  // by kind of answer: era, tick
};

}  // namespace visum::storm
