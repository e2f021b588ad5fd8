#include "tests/gateway/storm/client.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "protocol/codec.h"

namespace visum::storm {
namespace {

using namespace protocol;

constexpr Role kRoles[] = {Role::kController, Role::kController, Role::kAdmin, Role::kObserver};
constexpr OnTimeout kOnTimeouts[] = {OnTimeout::kEnd, OnTimeout::kHold, OnTimeout::kStop, OnTimeout::kFree};
constexpr std::int64_t kMs = 1'000'000;  // ns

}  // namespace

Client::Client(Dice& dice, int number, const PartDescription& part, Expect expect)
    : dice_(dice),
      name_("client " + std::to_string(number)),
      role_(kRoles[static_cast<std::size_t>(number) % std::size(kRoles)]),
      part_(part),
      expect_(std::move(expect)) {}

std::shared_ptr<Connection> Client::wants_connection() {
  if (connection_ || gone_ || !dice_.one_in(50)) return nullptr;
  connection_ = std::make_shared<Connection>(dice_);
  chattiness_ = 1 + dice_.below(40);
  next_id_ = 1;
  if (!dice_.one_in(40)) ask(Hello{1, 1, name_, role_, {}});
  return connection_;
}

void Client::turn(std::int64_t now_ms) {
  if (connection_ && silent_ && (connection_->reset || connection_->server_closed)) drop();
  if (!connection_ || silent_) return;
  hear(now_ms);
  if (!connection_) return;
  if (dice_.one_in(chattiness_)) say(now_ms);
  send(now_ms);
  if (dice_.one_in(400)) misbehave(now_ms);
}

void Client::leave() {
  gone_ = true;
  if (!connection_) return;
  connection_->reset = true;
  drop();
}

void Client::drop() {
  connection_.reset();
  unsent_.clear();
  unread_.clear();
  seen_.clear();
  silent_ = false;
}

// ----------------------------------------------------------------------------------------------------
// hearing

void Client::hear(std::int64_t now_ms) {
  if (connection_->reset) return drop();
  std::byte space[4096];
  const auto count = connection_->to_client.take(space, now_ms);
  unread_.insert(unread_.end(), space, space + count);
  std::size_t at = 0;
  while (unread_.size() - at >= kHeaderBytes) {
    const auto length =
        frame_length(std::span<const std::byte, kHeaderBytes>(unread_.data() + at, kHeaderBytes));
    if (unread_.size() - at < kHeaderBytes + length) break;
    std::string why;
    const auto frame = decode_reply(std::span(unread_).subspan(at + kHeaderBytes, length), why);
    expect_(frame.has_value(), "a client understands what it is sent: " + why);
    if (frame) understand(frame->reply, frame->reply_to);
    at += kHeaderBytes + length;
  }
  unread_.erase(unread_.begin(), unread_.begin() + static_cast<std::ptrdiff_t>(at));
  if (connection_->server_closed && connection_->to_client.empty()) drop();
}

void Client::understand(const Reply& reply, std::uint64_t reply_to) {
  if (const auto* error = std::get_if<Error>(&reply))
    expect_(error->code != ErrorCode::kInternal, "no internal error: " + error->text);
  // Samples overtake answers, so that each kind is followed by itself.
  if (const auto* sample = std::get_if<PartSample>(&reply))
    follow_time(reply_to == 0 ? 1 : 0, sample->era, sample->tick);
  if (const auto* sample = std::get_if<WorldSample>(&reply))
    follow_time(reply_to == 0 ? 2 : 0, sample->era, sample->tick);
  if (const auto* status = std::get_if<ServerStatus>(&reply)) follow_time(0, status->era, status->tick);
  if (const auto* advanced = std::get_if<Advanced>(&reply)) follow_time(0, advanced->era, advanced->tick);
}

void Client::follow_time(int kind, std::uint64_t era, std::int64_t tick) {
  const std::tuple now(era, tick);
  const auto [seen, first] = seen_.try_emplace(kind, now);
  expect_(first || now >= seen->second, "time does not go back within an era");
  seen->second = now;
}

// ----------------------------------------------------------------------------------------------------
// saying

void Client::say(std::int64_t now_ms) {
  const auto before = unsent_.size();
  ask(any_request());
  if (dice_.one_in(30)) {  // twice the same, as after a doubt
    const std::vector<std::byte> again(unsent_.begin() + static_cast<std::ptrdiff_t>(before), unsent_.end());
    unsent_.insert(unsent_.end(), again.begin(), again.end());
  }
  if (dice_.one_in(25))  // a flood
    for (auto more = dice_.below(80); more > 0; --more) ask(any_request());
  if (dice_.one_in(800)) unsent_[before + dice_.below(unsent_.size() - before)] ^= std::byte{0x20};
  send(now_ms);
}

void Client::ask(const Request& request) {
  encode_request(next_id_++, request, unsent_);
}

void Client::send(std::int64_t now_ms) {
  auto count = std::min(unsent_.size(), connection_->to_server.room());
  if (dice_.one_in(8)) count = std::min(count, dice_.below(32));
  connection_->to_server.put(std::span(unsent_).first(count), now_ms);
  unsent_.erase(unsent_.begin(), unsent_.begin() + static_cast<std::ptrdiff_t>(count));
}

void Client::misbehave(std::int64_t now_ms) {
  switch (dice_.below(6)) {
    case 0:  // cut off in the middle of whatever it said
      connection_->reset = true;
      return drop();
    case 1:  // goodbye
      connection_->client_left = true;
      return drop();
    case 2:
      return connection_->to_client.clog(now_ms + dice_.within(1, 4000));
    case 3:
      return connection_->to_server.clog(now_ms + dice_.within(1, 4000));
    case 4:
      silent_ = dice_.one_in(4);
      return;
    default:
      return ask(PushBody{"no such body", {0, 0, 1}, {}, {}, 1});
  }
}

Request Client::any_request() {
  switch (dice_.below(22)) {
    case 20:
      return about_events();
    case 21:  // it stands whatever they say: nothing may move a part that is to stand
      return dice_.one_in(2) ? Request(SetBody{"floor"}) : Request(PullBody{"floor", {}, {0, 0, 1}, 1.0});
    case 0:
      return ListParts{};
    case 1:
      return Status{};
    case 2:
      return DescribePart{dice_.one_in(4) ? "nobody" : part_.name};
    case 3:
      return GetParameters{part_.name};
    case 4:
      return ReadWorld{};
    case 5:
      return SubscribeWorld{static_cast<std::uint32_t>(dice_.below(40))};
    case 6:
      return dice_.one_in(2) ? Request(UnsubscribeWorld{}) : Request(DescribeWorld{});
    case 7:
    case 8:
    case 9:
      return about_time();
    default:
      return about_part();
  }
}

Request Client::about_part() {
  const auto& name = part_.name;
  switch (dice_.below(9)) {
    case 0:
    case 1:
      return AcquireLease{name, dice_.one_in(2) ? 0 : dice_.within(1, 300) * kMs, dice_.one_in(3)};
    case 2:
      return dice_.one_in(3) ? Request(ReleaseLease{name}) : Request(Read{name});
    case 3:
      return Subscribe{name, static_cast<std::uint32_t>(dice_.below(30))};
    case 4:
      return dice_.one_in(3) ? Request(Unsubscribe{name}) : Request(Read{name});
    default:
      return a_write();
  }
}

Request Client::a_write() {
  const auto& ports = part_.controller_inputs;
  Write write{part_.name, static_cast<std::uint32_t>(dice_.below(ports.size())), {}, 0};
  const auto most = ports.size() - write.first_port;
  for (std::size_t i = 0, count = 1 + dice_.below(most); i < count; ++i) {
    const auto& port = ports[write.first_port + i];
    const double low = std::max(port.minimum, -10.0), high = std::min(port.maximum, 10.0);
    write.values.push_back(port.unit.empty() ? port.initial : low + (high - low) * dice_.share());
  }
  if (dice_.one_in(20)) write.values.back() = std::numeric_limits<double>::quiet_NaN();
  if (dice_.one_in(20)) write.values.resize(ports.size() + 1);
  if (dice_.one_in(3)) write.sequence = dice_.one_in(5) ? 1 : sequence_++;
  return write;
}

Request Client::about_events() {
  switch (dice_.below(4)) {
    case 0:
      return SubscribeEvents{};
    case 1:
      return UnsubscribeEvents{};
    default:
      return Announce{"so it is", dice_.one_in(2) ? "check" : ""};
  }
}

Request Client::about_time() {
  switch (dice_.below(12)) {
    case 0:
      return Pause{};
    case 1:
    case 2:
      return Resume{};
    case 3:
      return Step{dice_.within(0, 20)};
    case 4:
      return dice_.one_in(6) ? Request(Reset{static_cast<ResetScope>(dice_.below(3))}) : Request(Status{});
    case 5:
      return TakeSnapshot{};
    case 6:
      return dice_.one_in(6) ? Request(RestoreSnapshot{1 + dice_.below(6)}) : Request(Status{});
    case 7:
      return Join{dice_.within(0, 200) * kMs, 0, kOnTimeouts[dice_.below(std::size(kOnTimeouts))]};
    case 8:
      return dice_.one_in(4) ? Request(Leave{}) : Request(Note{"busy"});
    default:
      return Advance{dice_.within(0, 15), false, 0, {}};
  }
}

}  // namespace visum::storm
