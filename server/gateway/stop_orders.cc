#include "server/gateway/stop_orders.h"

#include <algorithm>
#include <cstring>

namespace visum::gateway {

using namespace protocol;

namespace {

StopProof proof_wanted(const Tokens& tokens, bool sessions_only) {
  if (tokens.any_token([](const std::string&) { return true; })) return StopProof::kToken;
  return sessions_only || tokens.required() ? StopProof::kSession : StopProof::kNone;
}

}  // namespace

StopOrders::StopOrders(std::vector<std::string> parts, const Tokens& tokens, bool sessions_only,
                       StopLatch& latch)
    : parts_(std::move(parts)), tokens_(tokens), proof_(proof_wanted(tokens, sessions_only)), latch_(latch) {
  fill_with_random(secret_);
}

std::optional<StopDatagram> StopOrders::answer(std::span<const std::byte> bytes, const std::string& peer,
                                               Clock::time_point now) {
  const auto datagram = decode_stop(bytes);
  if (!datagram) return std::nullopt;
  if (const auto* ask = std::get_if<StopAsk>(&*datagram))
    return StopChallenge{ask->nonce, cookie_of(peer, ask->nonce, now.time_since_epoch() / kCookieSlice),
                         proof_};
  const auto* order = std::get_if<StopOrder>(&*datagram);
  if (!order) return std::nullopt;
  if (const auto why = refuse(*order, peer, now)) return StopRefused{order->nonce, *why};
  return obey(*order, peer, now);
}

KeyedHash StopOrders::cookie_of(const std::string& peer, const StopNonce& nonce, std::int64_t slice) const {
  std::vector<std::byte> message(sizeof slice);
  std::memcpy(message.data(), &slice, sizeof slice);
  message.insert(message.end(), nonce.begin(), nonce.end());
  const auto address = std::as_bytes(std::span(peer.data(), peer.size()));
  message.insert(message.end(), address.begin(), address.end());
  return keyed_hash(secret_, message);
}

std::optional<StopRefusal> StopOrders::refuse(const StopOrder& order, const std::string& peer,
                                              Clock::time_point now) const {
  const auto slice = now.time_since_epoch() / kCookieSlice;
  if (!equal_in_constant_time(order.cookie, cookie_of(peer, order.nonce, slice)) &&
      !equal_in_constant_time(order.cookie, cookie_of(peer, order.nonce, slice - 1)))
    return StopRefusal::kCookie;
  if (proof_ == StopProof::kSession) return StopRefusal::kSession;
  if (proof_ == StopProof::kToken && !tokens_.any_token([&](const std::string& token) {
        return equal_in_constant_time(order.proof, stop_proof(token, order.cookie, order.part));
      }))
    return StopRefusal::kProof;
  if (!order.part.empty() && std::ranges::find(parts_, order.part) == parts_.end()) return StopRefusal::kPart;
  return std::nullopt;
}

// The press comes before all bookkeeping: however many orders wait for an answer, the parts stop.
StopDatagram StopOrders::obey(const StopOrder& order, const std::string& peer, Clock::time_point now) {
  const auto is_this = [&](const Order& other) { return other.nonce == order.nonce && other.peer == peer; };
  if (const auto done = std::ranges::find_if(done_, is_this); done != done_.end())
    return StopActed{order.nonce, done->tick};
  if (std::ranges::any_of(waiting_, is_this)) return StopLatched{order.nonce};
  const auto part = std::ranges::find(parts_, order.part) - parts_.begin();
  const auto ticket = order.part.empty() ? latch_.press_all() : latch_.press(static_cast<std::size_t>(part));
  if (waiting_.size() == kMost) return StopRefused{order.nonce, StopRefusal::kBusy};
  waiting_.push_back({peer, order.nonce, ticket, now, 0});
  return StopLatched{order.nonce};
}

std::vector<std::pair<std::string, StopDatagram>> StopOrders::acted(Clock::time_point now) {
  std::vector<std::pair<std::string, StopDatagram>> answers;
  std::erase_if(waiting_, [&](Order& order) {
    if (!latch_.has_acted(order.ticket)) return now - order.since > kPatience;
    order.tick = latch_.tick();
    answers.emplace_back(order.peer, StopActed{order.nonce, order.tick});
    done_.push_back(std::move(order));
    return true;
  });
  while (done_.size() > kMost) done_.pop_front();
  return answers;
}

}  // namespace visum::gateway
