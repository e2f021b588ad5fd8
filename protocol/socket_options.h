// What both ends of a session ask of the kernel for their TCP connection.
#pragma once

namespace visum::protocol {

// Frames leave at once, and a peer that vanished without a word is noticed: while nothing is to be sent by
// probes, within 4 s; while something is, after 4 s without an acknowledgement (probes rest as long as that
// is open). So is one that reads nothing for 4 s while more is to be sent than the kernels hold. An option
// that is refused leaves the kernel's default.
void set_tcp_options(int socket);

}  // namespace visum::protocol
