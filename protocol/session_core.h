// One session without its socket: hello, requests, deadlines, bounded queue. A transport (stream_session.h,
// web_session.h, or a test) derives from it, feeds it with bytes and writes what it queued. It has no socket,
// no clock and no thread: everything is called on the server's one thread, and SessionContext gives the time.
// Owned by the server.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

#include "protocol/frame_buffer.h"
#include "protocol/server.h"
#include "protocol/write_queue.h"

namespace visum::protocol {

// The time that the server has spent serving since its start. Time that it spent elsewhere (in a debugger, in
// a slow tick) does not count against its clients. It advances with each sweep.
using ServedTime = std::chrono::nanoseconds;

// Shared by all sessions of a server; owned by the server.
struct SessionContext {
  const Limits& limits;
  SessionHandler& handler;
  ServedTime now{0};
  ServedTime step{0};  // how far `now` may lag behind
  std::atomic<std::uint64_t> refused{0};
  AddressLogs address_logs;
};

class SessionCore : public Session {
 public:
  SessionCore(SessionContext& context, std::uint64_t id, std::string peer);

  std::uint64_t id() const override { return id_; }
  const std::string& client_name() const override { return client_name_; }
  const std::string& peer() const override { return peer_; }
  Role role() const override { return role_; }
  std::size_t request_bytes() const override { return request_bytes_; }
  void send(std::uint64_t reply_to, const Reply& reply) override;
  bool behind() const override;
  bool send_latest(std::uint32_t stream, const Reply& sample) override;
  bool ready_for(std::uint32_t stream) const override { return !out_.has_waiting(stream); }
  void hold_back(bool on) override;
  void log(LogLevel level, const std::string& text) override;
  void close(CloseReason reason) override;

  // Sends the error as the last reply and closes.
  void refuse(std::uint64_t reply_to, Error error);

  bool awaits_hello() const { return phase_ == Phase::kHello; }
  bool closing() const { return phase_ == Phase::kClosing; }
  std::size_t bytes_to_send() const { return out_.bytes(); }
  bool held_back() const;
  CloseReason close_reason() const { return reason_; }

  // Tells the handler once that the session was closed, outside of the call that closed it.
  void tell_closed();

 protected:
  enum class Appetite {
    kMore,    // wants bytes
    kTurn,    // whole frames are left: serve the other sessions first, then call handle_frames() again
    kPaused,  // its replies must be written first, then call handle_frames() again
    kNone,    // closing
  };

  void end_hold() { held_back_since_.reset(); }
  // There is no memory for this session's bytes: gives back what it holds, tells the peer and closes.
  void out_of_memory();
  // Room for the bytes that come next; empty, and the session is closed: there is no memory.
  std::span<std::byte> room();
  // Asks for a call of flush(): there is something to write or to close. Called at most once per batch of
  // calls.
  virtual void wake() = 0;
  // Writes what can be written without waiting.
  virtual void flush() = 0;
  // The reason why there is no place for this session with the role that it was granted; "": there is one.
  virtual std::string refuse_place(Role) const { return {}; }

  FrameBuffer& in() { return in_; }
  WriteQueue& out() { return out_; }
  // Handles the frames that have arrived, up to a number per turn.
  Appetite handle_frames();
  void peer_closed();  // at the end of the peer's stream
  // Refuses a peer whose Hello or whose frame takes too long, and tells of lines that the log left out.
  void check_deadlines();
  // True if the session was behind() and the handler was not told of room since.
  bool owes_room() const { return owes_room_; }
  // If there is room again, tells the handler (never from within one of its calls) and returns true.
  bool tell_room();
  // True if `deadline` has passed since `since`, with allowance for the coarse clock.
  bool over(ServedTime since, std::chrono::milliseconds deadline) const;
  SessionContext& context() { return context_; }

 private:
  enum class Phase { kHello, kOpen, kClosing };

  std::size_t max_frame() const;
  // True if no further event may wait; events are then no longer accepted.
  bool queue_full() const;
  void handle(std::span<const std::byte> payload);
  void handle_hello(std::uint64_t id, const Request& request);
  void too_large(std::uint32_t length);
  // Calls `call`. Where memory runs out, the request is refused with BUSY, and the session stays if the
  // request's number is known. Any other exception is a bug of ours: it is logged, and the session is
  // refused.
  template <typename Call>
  void guarded(std::uint64_t request_id, Call call);

  SessionContext& context_;
  const std::uint64_t id_;
  const std::string peer_;
  std::string client_name_;
  std::optional<ClientLog> log_;  // once a role is granted
  Role role_ = Role::kUnspecified;
  std::size_t request_bytes_ = 0;
  Phase phase_ = Phase::kHello;
  CloseReason reason_ = CloseReason::kGoodbye;
  bool granted_ = false;
  bool told_ = false;
  bool owes_room_ = false;
  std::optional<std::chrono::steady_clock::time_point> held_back_since_;
  const ServedTime opened_;
  std::optional<ServedTime> frame_began_;
  FrameBuffer in_;
  WriteQueue out_;
};

}  // namespace visum::protocol
