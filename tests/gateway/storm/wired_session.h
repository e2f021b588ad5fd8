// A session of the server whose socket is a simulated connection, with the rules of stream_session.h.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "protocol/session_core.h"
#include "tests/gateway/storm/oracle.h"
#include "tests/gateway/storm/wire.h"

namespace visum::storm {

class WiredSession final : public protocol::SessionCore {
 public:
  WiredSession(protocol::SessionContext& context, Oracle& oracle, std::uint64_t id,
               std::shared_ptr<Connection> connection)
      : SessionCore(context, id, "storm:" + std::to_string(id)),
        oracle_(oracle),
        connection_(std::move(connection)) {}

  // Does what a readable and writable socket would cause.
  void turn(std::int64_t now_ms) {
    now_ms_ = now_ms;
    if (connection_->reset) return close(protocol::CloseReason::kLost);
    flush();
    tell_room();
    if (!closing()) read();
    flush();
    if (closing() && out().empty()) connection_->server_closed = true;
  }
  void sweep() {
    check_deadlines();
    if (blocked_since_ && over(*blocked_since_, context().limits.stall_deadline)) reset();
  }
  void reset() {
    connection_->reset = true;
    close(protocol::CloseReason::kLost);
  }
  bool gone() const { return closing() && (connection_->reset || connection_->server_closed); }

  void send(std::uint64_t reply_to, const protocol::Reply& reply) override {
    oracle_.sends(*this, reply_to, reply);
    SessionCore::send(reply_to, reply);
    oracle_.expect(out().waiting_replies() <= context().limits.max_queued_replies, "the queue is bounded");
  }

 private:
  void wake() override {}
  void flush() override {
    while (!out().empty() && !connection_->reset) {
      const auto bytes = out().front();
      const auto sent = std::min(bytes.size(), connection_->to_client.room());
      if (sent == 0) {
        if (!blocked_since_) blocked_since_ = context().now;
        return;
      }
      blocked_since_.reset();
      connection_->to_client.put(bytes.first(sent), now_ms_);
      out().written(sent);
    }
  }
  // Several frames a turn, as many as the handler has an appetite for.
  void read() {
    if (appetite_ == Appetite::kMore) {
      const auto bytes = connection_->to_server.take(in().space(), now_ms_);
      in().commit(bytes);
      if (bytes == 0) {
        if (connection_->client_left && connection_->to_server.empty()) peer_closed();
        return;
      }
    }
    appetite_ = handle_frames();
  }

  Oracle& oracle_;
  const std::shared_ptr<Connection> connection_;
  Appetite appetite_ = Appetite::kMore;
  std::optional<protocol::ServedTime> blocked_since_;
  std::int64_t now_ms_ = 0;
};

}  // namespace visum::storm
