// One session without its socket: hello, requests, deadlines, bounded queue. What feeds it with bytes and
// drains it (tcp_session.h, or a test) derives from it. No socket, no clock, no thread of its own: everything
// is called on the server's one thread, and time is what the context says.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

#include "protocol/frame_buffer.h"
#include "protocol/server.h"
#include "protocol/write_queue.h"

namespace visum::protocol {

// Time in which the server was there to serve, since its start: what it spent elsewhere (a debugger, a slow
// tick) does not count against its clients. Moves in steps of the sweep.
using ServedTime = std::chrono::nanoseconds;

// What all sessions of a server share.
struct SessionContext {
  const Limits& limits;
  SessionHandler& handler;
  ServedTime now{0};
  ServedTime step{0};  // how far `now` may lag behind
  std::atomic<std::uint64_t> refused{0};
};

class SessionCore : public Session {
 public:
  SessionCore(SessionContext& context, std::uint64_t id, std::string peer);

  std::uint64_t id() const override { return id_; }
  const std::string& client_name() const override { return client_name_; }
  const std::string& peer() const override { return peer_; }
  Role role() const override { return role_; }
  void send(std::uint64_t reply_to, const Reply& reply) override;
  bool behind() const override;
  bool send_latest(std::uint32_t stream, const Reply& sample) override;
  bool ready_for(std::uint32_t stream) const override { return !out_.has_waiting(stream); }
  void hold() override { held_ = phase_ == Phase::kOpen; }
  void close(CloseReason reason) override;

  // Says why, and closes.
  void refuse(std::uint64_t reply_to, Error error);

  bool awaits_hello() const { return phase_ == Phase::kHello; }
  bool closing() const { return phase_ == Phase::kClosing; }
  bool held() const { return held_ && phase_ == Phase::kOpen && !owes_room_; }
  CloseReason close_reason() const { return reason_; }

  // Tells the handler of a close, once, outside of the call that caused it.
  void tell_closed();

 protected:
  enum class Appetite {
    kMore,    // wants bytes
    kTurn,    // whole frames are left: others first, then handle_frames() again
    kPaused,  // its replies must be written first, then handle_frames() again
    kNone,    // closing
  };

  void end_hold() { held_ = false; }
  // There is something to write or to close; comes at most once per batch of calls.
  virtual void wake() = 0;
  // Writes now what can be written without waiting.
  virtual void flush() = 0;

  FrameBuffer& in() { return in_; }
  WriteQueue& out() { return out_; }
  Appetite handle_frames();
  void peer_closed();  // the end of the stream
  void check_deadlines();
  // It was behind() and has not told the handler of room since.
  bool owes_room() const { return owes_room_; }
  // Tells it where there is room again, outside of the handler's calls; whether it did.
  bool tell_room();
  bool over(ServedTime since, std::chrono::milliseconds deadline) const;
  SessionContext& context() { return context_; }

 private:
  enum class Phase { kHello, kOpen, kClosing };

  std::size_t max_frame() const;
  bool queue_full() const;
  void handle(std::span<const std::byte> payload);
  void handle_hello(std::uint64_t id, const Request& request);
  void too_large(std::uint32_t length);
  template <typename Call>
  void guarded(std::uint64_t request_id, Call call);

  SessionContext& context_;
  const std::uint64_t id_;
  const std::string peer_;
  std::string client_name_;
  Role role_ = Role::kUnspecified;
  Phase phase_ = Phase::kHello;
  CloseReason reason_ = CloseReason::kGoodbye;
  bool granted_ = false;
  bool told_ = false;
  bool owes_room_ = false;
  bool held_ = false;
  const ServedTime opened_;
  std::optional<ServedTime> frame_began_;
  FrameBuffer in_;
  WriteQueue out_;
};

}  // namespace visum::protocol
