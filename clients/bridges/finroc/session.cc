#include "clients/bridges/finroc/session.h"

#include <algorithm>

#include "clients/bridges/finroc/administration.h"
#include "clients/bridges/finroc/records.h"

namespace visum::finroc {
namespace {

enum Code : std::uint8_t {
  kSubscribe = 0,
  kUnsubscribe = 1,
  kPull = 2,
  kPullAnswer = 3,
  kCall = 4,
  kTypeUpdate = 5,
  kCreated = 6,
  kPortChanged = 7,
  kDeleted = 8,
  kPeerInfo = 9,
  kValue = 10,
  kSmallValue = 11,
  kSmallValueWithoutTime = 12,
};
enum CallKind : std::uint8_t { kRequest = 1, kResponse = 2 };
enum CallStatus : std::uint8_t { kReady = 1, kInvalidCall = 7 };
enum Change : std::uint8_t { kChanged = 1, kInitial = 2 };

constexpr std::size_t kSizeBytes = 4;
constexpr std::int16_t kNoAcknowledgement = -1;
constexpr std::size_t kMostWaitingBytes = 16u << 20;    // of answers that the peer does not read
constexpr std::size_t kMostStructureBytes = 32u << 10;  // of one structure packet that we send
constexpr std::uint32_t kAnsweredFlags = connection::kPrimary | connection::kExpress | connection::kBulk;

}  // namespace

Session::Session(Board& board, Greeting own) : board_(board), own_(std::move(own)) {}

void Session::receive(std::span<const std::byte> bytes) {
  if (!ended_.empty()) return;
  input_.insert(input_.end(), bytes.begin(), bytes.end());
  std::size_t taken = 0;
  while (ended_.empty()) {
    const std::size_t step = take_one(std::span(input_).subspan(taken));
    if (step == 0) break;
    taken += step;
  }
  input_.erase(input_.begin(), input_.begin() + static_cast<std::ptrdiff_t>(taken));
  if (messages_.size() > kMostWaitingBytes) ended_ = "it asks for more than it reads";
}

std::size_t Session::take_one(std::span<const std::byte> bytes) {
  if (state_ == State::kGreeting) return take_greeting(bytes);
  if (bytes.size() < kSizeBytes) return 0;
  const auto size = Reader(bytes).take<std::uint32_t>();
  if (size > kMostBatchBytes) {
    ended_ = "it announces " + std::to_string(size) + " bytes at once";
    return 0;
  }
  if (bytes.size() < kSizeBytes + size) return 0;
  if (state_ == State::kItsStructure) {  // we have no use for it
    if (size == 0) state_ = State::kBatches;
  } else {
    take_batch(Reader(bytes.subspan(kSizeBytes, size)));
  }
  return kSizeBytes + size;
}

std::size_t Session::take_greeting(std::span<const std::byte> bytes) {
  GreetingRead read = read_greeting(bytes);
  if (read.state == GreetingRead::State::kBad) ended_ = read.why;
  if (read.state != GreetingRead::State::kComplete) return 0;
  peer_ = std::move(read.greeting);
  peer_name_ = peer_.name + " " + peer_.host + ":" + std::to_string(peer_.process);
  Greeting answer = own_;
  answer.flags = peer_.flags & kAnsweredFlags;  // the upper half stays 0: serialization revision 0
  output() += write_greeting(answer);
  changes_sent_ = board_.changes().size();
  if ((peer_.flags & connection::kPrimary) != 0) {
    send_structure();
    state_ = State::kItsStructure;
  } else {
    state_ = State::kBatches;
  }
  return read.taken;
}

void Session::send_structure() {
  Writer packet;
  const auto send_packet = [&] {
    if (packet.text().empty()) return;
    output() += Writer().put(static_cast<std::uint32_t>(packet.text().size())).text() + packet.text();
    packet = Writer();
  };
  if (peer_.wants == Structure::kSharedPorts) types_sent_.put(packet, {Kind::kText, "String", {}});
  for (ElementId id = 1; id < board_.elements().size(); ++id) {
    if (!is_shown(board_, id, peer_.wants)) continue;
    put_record(packet, board_, id, peer_.wants, types_sent_);
    if (packet.text().size() > kMostStructureBytes) send_packet();
  }
  send_packet();
  output() += Writer().put(std::uint32_t{0}).text();
}

// ---------------------------------------- what the peer says

void Session::take_batch(Reader batch) {
  const auto wants_acknowledgement = batch.take<std::int16_t>();
  batch.take<std::int16_t>();  // acknowledges a batch of ours: we do not wait for that
  if (wants_acknowledgement >= 0) to_acknowledge_ = wants_acknowledgement;
  while (!batch.at_end() && take_message(batch)) {
  }
}

// Returns false if the rest of the batch cannot be understood, and is to be skipped.
bool Session::take_message(Reader& batch) {
  const auto code = batch.take<std::uint8_t>();
  switch (code) {
    case kSubscribe:
      subscribe(batch);
      break;
    case kUnsubscribe:
      subscriptions_.erase(static_cast<ElementId>(batch.take<std::uint32_t>() >> kStampBits));
      note_shortest_interval();
      break;
    case kPull:
      take_pull(batch);
      break;
    case kDeleted:
      batch.take<std::int32_t>();
      break;
    case kPullAnswer:
    case kCall:
    case kTypeUpdate:
    case kCreated:
    case kPortChanged:
    case kPeerInfo:
    case kValue:
    case kSmallValue:
    case kSmallValueWithoutTime: {
      const bool small = code == kSmallValue || code == kSmallValueWithoutTime;
      const std::size_t size = small ? batch.take<std::uint8_t>() : batch.take<std::uint32_t>();
      const auto body = batch.take_bytes(size);
      if (batch.failed() || body.empty() || static_cast<std::uint8_t>(body.back()) != kEndMark) return false;
      take_sized(code, Reader(body.first(body.size() - 1)));
      return true;
    }
    default:
      return false;
  }
  return batch.take<std::uint8_t>() == kEndMark && !batch.failed();
}

void Session::take_sized(std::uint8_t code, Reader body) {
  switch (code) {
    case kCall:
      take_call(body);
      break;
    case kTypeUpdate:
      types_heard_.take(body);
      break;
    case kValue:
    case kSmallValue:
      take_written_value(body, true);
      break;
    case kSmallValueWithoutTime:
      take_written_value(body, false);
      break;
    default:
      break;  // of no use to us
  }
}

void Session::subscribe(Reader& in) {
  const auto id = static_cast<ElementId>(in.take<std::uint32_t>() >> kStampBits);
  in.take<std::int16_t>();  // strategy: however long its queue is, it gets the newest value
  in.take_bool();           // reverse push
  const auto interval_ms = in.take<std::int16_t>();
  Subscription subscription;
  subscription.peers_handle = in.take<std::int32_t>();
  subscription.encoding = static_cast<Encoding>(in.take<std::uint8_t>());
  subscription.interval = std::chrono::milliseconds(std::max<int>(interval_ms, 0));
  if (in.failed() || subscription.encoding > Encoding::kText || !board_.is_living_port(id)) return;
  if (board_.elements()[id].type.kind == Kind::kAdministration) return;
  subscriptions_[id] = subscription;
  every_ = std::min(every_, subscription.interval);
}

void Session::note_shortest_interval() {
  every_ = kNever;
  for (const auto& [id, subscription] : subscriptions_) every_ = std::min(every_, subscription.interval);
}

// A peer that only connects sends the value that its own port happens to have, as an initial one. Nothing may
// move by that, so only changes are taken.
void Session::take_written_value(Reader& body, bool with_times) {
  const auto id = static_cast<ElementId>(body.take<std::uint32_t>() >> kStampBits);
  const auto encoding = static_cast<Encoding>(body.take<std::uint8_t>());
  if (body.failed() || !board_.is_living_port(id)) return;
  const Element element = board_.elements()[id];  // a copy: writing may add elements
  std::optional<Value> newest;
  bool more = true;
  while (more && !body.failed()) {
    const auto change = body.take<std::uint8_t>();
    if (with_times) body.take<std::int64_t>();
    const auto value = take_value(body, element.type, encoding);
    more = body.take_bool();
    if (!body.failed() && change == kChanged) newest = value;
  }
  if (body.failed() || !newest || element.access != Access::kWrite) return;
  if (!board_.write(id, *newest, peer_name_).empty()) board_.send_again(id);
}

void Session::take_call(Reader& body) {
  const auto handle = body.take<std::int32_t>();
  const auto kind = body.take<std::uint8_t>();
  const std::string type = types_heard_.take(body);
  const auto method = body.take<std::uint8_t>();
  if (body.failed() || kind != kRequest) return;  // a message without an answer asks for nothing that we do
  const auto call = body.take<std::int64_t>();
  body.take<std::int64_t>();  // time-out
  if (body.failed()) return;
  const auto id = static_cast<ElementId>(static_cast<std::uint32_t>(handle) >> kStampBits);
  std::optional<std::string> result;
  if (board_.is_living_port(id) && board_.elements()[id].type.kind == Kind::kAdministration) {
    result = call_administration(board_, peer_name_, method, body);
  }
  Writer answer;
  answer.put(handle).put(std::uint8_t{kResponse});
  types_sent_.put(answer, {Kind::kAdministration, "Administration Interface", {}});
  answer.put(method).put(call).put_bool(false);
  answer.put(static_cast<std::uint8_t>(result ? kReady : kInvalidCall)).put_bytes(result.value_or(""));
  add_message(kCall, 4, answer.text());
}

// Peers of serialization revision 1703 misread a successful answer, so that each pull fails; values are
// subscribed.
void Session::take_pull(Reader& in) {
  in.take<std::int32_t>();
  const auto call = in.take<std::int64_t>();
  in.take<std::uint8_t>();
  if (!in.failed()) add_message(kPullAnswer, 4, Writer().put(call).put_bool(true).text());
}

// ---------------------------------------- what we say

void Session::add_message(std::uint8_t code, int size_bytes, const std::string& body) {
  Writer message;
  message.put(code);
  const std::size_t size = body.size() + 1;
  if (size_bytes == 4) message.put(static_cast<std::uint32_t>(size));
  message.put_bytes(body).put(kEndMark);
  messages_ += message.text();
}

void Session::add_changes() {
  const auto& changes = board_.changes();
  for (; changes_sent_ < changes.size(); ++changes_sent_) {
    const auto [kind, id] = changes[changes_sent_];
    if (kind == Board::Change::Kind::kDeleted) {
      subscriptions_.erase(id);
      note_shortest_interval();
      if (peer_.wants != Structure::kNone) {
        add_message(kDeleted, 0, Writer().put(handle_of(id)).text());
      }
    } else if (!is_shown(board_, id, peer_.wants)) {
      continue;
    } else if (kind == Board::Change::Kind::kCreated) {
      Writer record;
      put_record(record, board_, id, peer_.wants, types_sent_);
      add_message(kCreated, 4, record.text());
    } else if (peer_.wants == Structure::kFinstruct) {
      Writer record;
      put_changed_port(record, board_, id);
      add_message(kPortChanged, 4, record.text());
    }
  }
}

void Session::add_value(const Element& element, Subscription& subscription) {
  Writer body;
  body.put(subscription.peers_handle).put(static_cast<std::uint8_t>(subscription.encoding));
  body.put(static_cast<std::uint8_t>(subscription.sent ? kChanged : kInitial)).put(element.time_ns);
  put_value(body, element.type, element.value, element.unit, subscription.encoding);
  body.put_bool(false);
  add_message(kValue, 4, body.text());
}

void Session::send_due(bridge::Clock::time_point now) {
  if (state_ != State::kBatches || !ended_.empty()) return;
  if ((peer_.flags & connection::kPrimary) != 0) add_changes();
  for (auto& [id, subscription] : subscriptions_) {
    const Element& element = board_.elements()[id];
    if (element.deleted || subscription.sent == element.revision) continue;
    if (now < subscription.due) continue;
    add_value(element, subscription);
    subscription.sent = element.revision;
    // A value that was a little late does not delay those that follow.
    const bool little_late = now - subscription.due < subscription.interval;
    subscription.due = (little_late ? subscription.due : now) + subscription.interval;
  }
  if (messages_.empty() && !to_acknowledge_) return;
  Writer batch;
  batch.put(static_cast<std::uint32_t>(2 + 2 + messages_.size()));
  batch.put(kNoAcknowledgement).put(to_acknowledge_.value_or(kNoAcknowledgement)).put_bytes(messages_);
  output() += batch.text();
  messages_.clear();
  to_acknowledge_.reset();
}

}  // namespace visum::finroc
