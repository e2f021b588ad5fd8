// The Unix sockets on which programs of one run meet. `visum run` puts a random word into the environment of
// all programs that it starts, as VISUM_LOCAL. A server with that word listens on a socket named by the word
// and its TCP port, beside that port; a client with it, which connects to this machine in plain text, tries
// that socket first. Sending takes less than half of the time that it takes over TCP, and the bytes are the
// same. Only 127.0.0.1 has such sockets: several addresses may have servers at one port. Names are in Linux's
// abstract namespace, which reaches as far as 127.0.0.1 does, leaves no files, and keeps no other user of
// this machine out: roles and tokens are those of TCP. Any thread. Source: unix(7).
#pragma once

#include <sys/un.h>

#include <cstdint>
#include <string>

namespace visum::protocol {

inline constexpr const char* kLocalVariable = "VISUM_LOCAL";

// The name of the socket beside a TCP port; empty where the environment holds no word.
std::string local_socket_name(std::uint16_t port);

struct LocalAddress {
  sockaddr_un address{};
  unsigned size = 0;  // bytes of it in use
};
LocalAddress local_address(const std::string& name);

// Puts a new random word into the environment, unless it holds one. Call it before other threads begin.
void share_local_sockets();

}  // namespace visum::protocol
