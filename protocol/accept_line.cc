#include "protocol/accept_line.h"

#include <algorithm>

#include "protocol/wire_session.h"

namespace visum::protocol {

namespace ip = boost::asio::ip;

ip::address share_of(const ip::address& address) {
  const auto plain = unmapped(address);
  if (plain.is_v4()) return plain;
  auto bytes = plain.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), std::uint8_t{0});
  return ip::address_v6(bytes);
}

bool AcceptLine::add(Socket socket, const Endpoint& peer) {
  by_share_[share_of(peer.address())].emplace_back(std::move(socket), peer);
  if (++waiting_ <= kMaxWaiting) return true;
  drop_newest_of_busiest();
  return false;
}

std::pair<AcceptLine::Socket, AcceptLine::Endpoint> AcceptLine::take() {
  auto next = by_share_.upper_bound(last_);
  if (next == by_share_.end()) next = by_share_.begin();
  last_ = next->first;
  auto first = std::move(next->second.front());
  next->second.pop_front();
  if (next->second.empty()) by_share_.erase(next);
  --waiting_;
  return first;
}

void AcceptLine::clear() {
  by_share_.clear();
  waiting_ = 0;
}

void AcceptLine::drop_newest_of_busiest() {
  const auto busiest = std::max_element(by_share_.begin(), by_share_.end(), [](const auto& a, const auto& b) {
    return a.second.size() < b.second.size();
  });
  busiest->second.pop_back();
  if (busiest->second.empty()) by_share_.erase(busiest);
  --waiting_;
}

}  // namespace visum::protocol
