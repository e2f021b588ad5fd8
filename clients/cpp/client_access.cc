#include "clients/cpp/client_access.h"

#include "clients/cpp/client_state.h"

namespace visum {

protocol::Reply ClientAccess::request(Client& client, const protocol::Request& request) {
  return client.state_->request(request);
}

void ClientAccess::post(Client& client, const protocol::Request& request) try {
  ++client.state_->requests;
  client.state_->link().post(request);
} catch (const protocol::ConnectionError& error) {
  throw Error(ErrorCode::kConnection, error.what());
}

std::optional<protocol::Reply> ClientAccess::next(Client& client) try {
  return client.state_->link().next_kept();
} catch (const protocol::ConnectionError& error) {
  throw Error(ErrorCode::kConnection, error.what());
}

void ClientAccess::drop(Client& client) noexcept {
  client.state_->connection.reset();
}

}  // namespace visum
