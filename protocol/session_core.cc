#include "protocol/session_core.h"

#include <spdlog/spdlog.h>

#include <cassert>
#include <exception>
#include <new>
#include <utility>

#include "protocol/codec.h"
#include "protocol/hello.h"

namespace visum::protocol {
namespace {

constexpr int kRequestsPerTurn = 64;            // then other sessions have their turn
constexpr std::size_t kIdleBytes = 16u << 10;   // receive buffer between frames
constexpr std::size_t kHelloBufferBytes = 512;  // receive buffer before the hello

constexpr const char* kNoMemory =
    "not enough memory is left for this request: the limit (ulimit -v, or the container's) is reached";

std::string in_words(std::chrono::milliseconds time) {
  return std::to_string(time.count()) + " ms";
}

}  // namespace

SessionCore::SessionCore(SessionContext& context, std::uint64_t id, std::string peer)
    : context_(context),
      id_(id),
      peer_(std::move(peer)),
      opened_(context.now),
      in_(kHelloBufferBytes, kHelloBufferBytes) {}

// ---------------------------------------- sending

void SessionCore::send(std::uint64_t reply_to, const Reply& reply) {
  assert(phase_ != Phase::kHello && "nothing may be sent before Welcome");
  if (phase_ != Phase::kOpen) return;
  if (queue_full() && !out_.in_flight()) flush();
  if (phase_ != Phase::kOpen) return;
  // Only events need this check: the handler sends no replies while behind().
  if (reply_to == 0 && queue_full()) return close(CloseReason::kLost);
  try {
    out_.push(reply_to, reply, context_.limits.max_frame_to_client);
  } catch (const std::bad_alloc&) {  // a client must not wait for an answer that never comes
    return close(CloseReason::kLost);
  }
  owes_room_ = owes_room_ || behind();
  if (reply_to == 0) end_hold();
  wake();
}

void SessionCore::hold_back(bool on) {
  if (!on) end_hold();
  if (on && !held_back_since_) held_back_since_ = std::chrono::steady_clock::now();
}

bool SessionCore::held_back() const {
  return held_back_since_ && phase_ == Phase::kOpen && !owes_room_ &&
         std::chrono::steady_clock::now() - *held_back_since_ < context_.limits.longest_hold_back;
}

bool SessionCore::send_latest(std::uint32_t stream, const Reply& sample) {
  if (phase_ != Phase::kOpen) return true;
  end_hold();
  wake();
  return out_.push_latest(stream, sample, context_.limits.max_frame_to_client);
}

void SessionCore::refuse(std::uint64_t reply_to, Error error) {
  if (phase_ == Phase::kClosing) return;
  context_.refused.fetch_add(1, std::memory_order_relaxed);
  log(LogLevel::kDebug, "session " + std::to_string(id_) + " (" + peer_ + "): refused: " + error.text);
  out_.push(reply_to, std::move(error), context_.limits.max_frame_to_client);
  close(CloseReason::kRefused);
}

void SessionCore::log(LogLevel level, const std::string& text) {
  ClientLog& lines = log_ ? *log_ : context_.address_logs.of(peer_);
  lines.write(level, text);
}

void SessionCore::close(CloseReason reason) {
  if (phase_ == Phase::kClosing) return;
  phase_ = Phase::kClosing;
  reason_ = reason;
  wake();
}

void SessionCore::tell_closed() {
  if (phase_ != Phase::kClosing || !granted_ || std::exchange(told_, true)) return;
  guarded(0, [this] { context_.handler.on_close(*this, reason_); });
}

// Counts the bytes of events only: one reply may be larger than all that may wait, and must not displace
// events.
bool SessionCore::queue_full() const {
  return out_.waiting_replies() >= context_.limits.max_queued_replies ||
         out_.waiting_event_bytes() >= context_.limits.max_queued_bytes;
}

bool SessionCore::tell_room() {
  if (phase_ != Phase::kOpen || !owes_room_ || behind()) return false;
  owes_room_ = false;
  guarded(0, [this] { context_.handler.on_room(*this); });
  return true;
}

// ---------------------------------------- receiving

// A client that asks faster than it reads gets its answers later. Half of the queue stays free for events.
bool SessionCore::behind() const {
  return out_.waiting_replies() >= context_.limits.max_queued_replies / 2 ||
         out_.waiting_bytes() >= context_.limits.max_queued_bytes / 2;
}

void SessionCore::out_of_memory() {
  in_.give_up();
  try {
    refuse(0, {ErrorCode::kBusy, kNoMemory, {}});
  } catch (const std::bad_alloc&) {
    close(CloseReason::kLost);
  }
}

std::span<std::byte> SessionCore::room() {
  try {
    return in_.space();
  } catch (const std::bad_alloc&) {
    spdlog::error("session {} ({}, {}): {}", id_, client_name_, peer_, kNoMemory);
    out_of_memory();
    return {};
  }
}

SessionCore::Appetite SessionCore::handle_frames() {
  for (int handled = 0; phase_ != Phase::kClosing; ++handled) {
    if (behind() && !out_.in_flight()) flush();
    if (behind()) return Appetite::kPaused;
    if (handled == kRequestsPerTurn) return Appetite::kTurn;
    const FrameBuffer::Next next = in_.next(max_frame());
    if (next.state == FrameBuffer::State::kFrame) {
      frame_began_.reset();
      handle(next.payload);
    } else if (next.state == FrameBuffer::State::kTooLarge) {
      too_large(next.length);
    } else {
      if (next.state == FrameBuffer::State::kPartial && !frame_began_) frame_began_ = context_.now;
      return Appetite::kMore;
    }
  }
  return Appetite::kNone;
}

void SessionCore::handle(std::span<const std::byte> payload) {
  guarded(0, [&] {
    std::string why;
    const auto frame = decode_request(payload, context_.limits.max_depth, why);
    if (!frame) return refuse(0, {ErrorCode::kMalformed, why, {}});
    if (phase_ == Phase::kHello) return handle_hello(frame->id, frame->request);
    if (std::holds_alternative<Hello>(frame->request))
      return refuse(frame->id, {ErrorCode::kMalformed, "a second Hello", {}});
    request_bytes_ = payload.size();
    guarded(frame->id, [&] { context_.handler.on_request(*this, frame->id, frame->request); });
  });
}

void SessionCore::handle_hello(std::uint64_t id, const Request& request) {
  const Hello* hello = std::get_if<Hello>(&request);
  if (!hello) return refuse(id, {ErrorCode::kMalformed, "the first message must be Hello", {}});
  Welcome welcome;
  if (auto refusal = refuse_hello(*hello, welcome.version)) return refuse(id, std::move(*refusal));
  client_name_ = hello->client_name.empty() ? peer_ : hello->client_name;
  welcome.session = id_;
  Error refusal;
  const Role role = context_.handler.on_hello(*this, *hello, welcome, refusal);
  if (role == Role::kUnspecified) return refuse(id, std::move(refusal));
  role_ = welcome.role = role;
  granted_ = true;
  log_.emplace("'" + client_name_ + "' at " + peer_);
  if (const std::string full = refuse_place(role); !full.empty())
    return refuse(id, {ErrorCode::kBusy, full, {}});
  if (phase_ == Phase::kClosing) return;
  phase_ = Phase::kOpen;
  in_.reserve(kIdleBytes);
  send(id, welcome);
}

std::size_t SessionCore::max_frame() const {
  const Limits& limits = context_.limits;
  if (phase_ == Phase::kHello) return limits.max_frame_before_hello;
  return role_ == Role::kAdmin ? limits.max_frame_admin : limits.max_frame;
}

void SessionCore::too_large(std::uint32_t length) {
  refuse(0, {ErrorCode::kTooLarge,
             "a frame of " + std::to_string(length) + " bytes, over the limit of " +
                 std::to_string(max_frame()) + (phase_ == Phase::kHello ? " before Hello" : ""),
             {}});
}

void SessionCore::peer_closed() {
  close(frame_began_ ? CloseReason::kLost : CloseReason::kGoodbye);
}

// ---------------------------------------- time, faults

bool SessionCore::over(ServedTime since, std::chrono::milliseconds deadline) const {
  return context_.now - since > deadline + context_.step;
}

void SessionCore::check_deadlines() {
  if (log_) log_->sweep();
  const Limits& limits = context_.limits;
  if (phase_ == Phase::kHello && over(opened_, limits.hello_deadline))
    refuse(0, {ErrorCode::kTimeout, "no Hello within " + in_words(limits.hello_deadline), {}});
  if (phase_ != Phase::kClosing && frame_began_ && over(*frame_began_, limits.frame_deadline))
    refuse(0,
           {ErrorCode::kTimeout, "a frame was not complete within " + in_words(limits.frame_deadline), {}});
}

// An exception of the handler is a bug of ours. It costs this session, not the server.
template <typename Call>
void SessionCore::guarded(std::uint64_t request_id, Call call) {
  std::string what = "unknown exception";
  try {
    return call();
  } catch (const std::bad_alloc&) {
    spdlog::error("session {} ({}, {}): {}", id_, client_name_, peer_, kNoMemory);
    if (request_id == 0) return out_of_memory();
    return send(request_id, Error{ErrorCode::kBusy, kNoMemory, {}});
  } catch (const std::exception& error) {
    what = error.what();
  } catch (...) {
  }
  log(LogLevel::kError,
      "session " + std::to_string(id_) + " (" + client_name_ + ", " + peer_ + "): internal error: " + what);
  refuse(request_id, {ErrorCode::kInternal, "internal error: " + what, {}});
}

}  // namespace visum::protocol
