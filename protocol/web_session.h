// A session over WebSocket: the byte stream of a TCP session, carried in binary messages. Owned by the
// server, used on its thread. Boost.Beast stays inside web_session.cc and http_connection.cc.
#pragma once

#include <memory>

#include "protocol/http_door.h"
#include "protocol/wire_session.h"

namespace visum::protocol {

// Makes the session. Its start() answers the handshake.
std::unique_ptr<WireSession> make_web_session(SessionContext& context, SessionOwner& owner, std::uint64_t id,
                                              const boost::asio::ip::tcp::endpoint& peer,
                                              UpgradePointer upgrade);

// Reads the client's address. Returns false if the client is gone already.
bool peer_of(const Upgrade& upgrade, boost::asio::ip::tcp::endpoint& peer);

}  // namespace visum::protocol
