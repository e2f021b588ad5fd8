#include "protocol/http_door.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "protocol/http_connection.h"

namespace visum::protocol {
namespace {

constexpr std::size_t kMaxConnections = 64;  // a browser opens at most six, and keeps them for a while

}  // namespace

HttpDoor::HttpDoor(boost::asio::io_context& io, const std::string& address, WebOptions options,
                   const TlsContext* tls, SessionContext& context, HttpOwner& owner)
    : options_(std::move(options)), tls_(tls), context_(context), owner_(owner) {
  const auto listen = [&](std::uint16_t port) {
    return std::make_unique<Listener>(
        io, address, port, context.limits.accepts_per_second,
        [this](Listener::Socket socket, const auto& peer) { admit(std::move(socket), peer); });
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

// Over the limit a connection is closed without an answer: a browser tries again.
void HttpDoor::admit(Listener::Socket socket, const boost::asio::ip::tcp::endpoint&) {
  forget_finished();
  if (connections_.size() >= kMaxConnections) {
    context_.refused.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  auto& connection = connections_.emplace_back(
      std::make_unique<HttpConnection>(std::move(socket), tls_, *rules_, *options_.pages, context_, owner_));
  connection->start();
  owner_.http_connected();
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
