// A session over WebSocket: the byte stream of a TCP session, carried in binary messages. Internal to the
// server; Boost.Beast stays inside web_session.cc and http_connection.cc.
#pragma once

#include <memory>

#include "protocol/http_door.h"
#include "protocol/wire_session.h"

namespace visum::protocol {

// Answers the handshake once started.
std::unique_ptr<WireSession> make_web_session(SessionContext& context, SessionOwner& owner, std::uint64_t id,
                                              const boost::asio::ip::tcp::endpoint& peer,
                                              UpgradePointer upgrade);

// The client's address; nothing if it is gone already.
bool peer_of(const Upgrade& upgrade, boost::asio::ip::tcp::endpoint& peer);

}  // namespace visum::protocol
