// Options that both ends of a session set on their TCP socket.
#pragma once

namespace visum::protocol {

// Sends frames at once and makes the kernel notice a peer that vanished: within 4 s by probes while nothing
// waits to be sent, and after 4 s without an acknowledgement otherwise (the kernel sends no probes then). A
// peer that reads nothing for 4 s while the kernels' buffers are full counts as vanished, too. If the kernel
// refuses an option, its default remains.
void set_tcp_options(int socket);

}  // namespace visum::protocol
