#include "protocol/http_door.h"

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "protocol/http_connection.h"

namespace visum::protocol {

HttpDoor::HttpDoor(boost::asio::io_context& io, const std::string& address, WebOptions options,
                   const TlsContext* tls, SessionContext& context, HttpOwner& owner)
    : options_(std::move(options)), tls_(tls), context_(context), owner_(owner) {
  const auto listen = [&](std::uint16_t port) {
    return std::make_unique<Listener>(
        io, address, port, context.limits.accepts_per_second,
        [this](Listener::Socket socket, const auto& peer) { admit(std::move(socket), peer); },
        [this] { context_.refused.fetch_add(1, std::memory_order_relaxed); });
  };
  try {
    listener_ = listen(options_.port);
  } catch (const std::runtime_error&) {
    if (!options_.any_if_taken) throw;
    listener_ = listen(0);
  }
  rules_ = std::make_unique<HttpRules>(listener_->port(), options_.hosts, tls_ != nullptr);
}

HttpDoor::~HttpDoor() = default;

void HttpDoor::admit(Listener::Socket socket, const boost::asio::ip::tcp::endpoint& peer) {
  forget_finished();
  make_room();
  auto& connection = connections_.emplace_back(std::make_unique<HttpConnection>(
      std::move(socket), peer, tls_, *rules_, *options_.pages, context_, owner_));
  connection->start();
  owner_.http_connected();
}

// Connections between two requests yield first, then those of the address with the most connections, then the
// oldest: a browser opens six at most.
void HttpDoor::make_room() {
  std::map<boost::asio::ip::address, std::size_t> of_share;
  std::vector<HttpConnection*> open;
  for (auto& connection : connections_) {
    if (!connection->is_open()) continue;
    open.push_back(connection.get());
    ++of_share[share_of(connection->address())];
  }
  if (open.size() < context_.limits.max_http_connections) return;
  const auto first_to_yield = std::ranges::min_element(open, {}, [&](const HttpConnection* connection) {
    const auto others = std::numeric_limits<std::size_t>::max() - of_share[share_of(connection->address())];
    return std::tuple(!connection->is_idle(), others, connection->since());
  });
  if (first_to_yield == open.end()) return;
  if (!(*first_to_yield)->is_idle()) context_.refused.fetch_add(1, std::memory_order_relaxed);
  (*first_to_yield)->close();
}

void HttpDoor::sweep() {
  for (auto& connection : connections_) connection->sweep();
  forget_finished();
}

void HttpDoor::close() {
  listener_->close();
  for (auto& connection : connections_) connection->close();
}

void HttpDoor::forget_finished() {
  std::erase_if(connections_, [](const auto& connection) { return connection->finished(); });
}

}  // namespace visum::protocol
