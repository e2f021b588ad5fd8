// Tells where a descriptor leads, as far as waiting on it depends on that.
#pragma once

#include <cstddef>
#include <cstdint>

#include "clients/shim/channel.h"

namespace visum::shim {

struct Descriptor {
  bool can_wait = false;  // false for files and folders
  bool is_socket = false;
  bool is_tty = false;       // of a bus
  Stream* stream = nullptr;  // to a bus, over TCP
  bool is_session = false;   // the ports over TCP: the server answers at once, in real time
  bool on_bus() const { return is_tty || stream != nullptr; }
  std::uint64_t stream_bit() const;  // the stream's place in `Shared::streams`, as a bit; 0: no stream
};
// Asks the kernel each time: descriptors change hands in ways that nobody sees.
Descriptor descriptor(int fd);

// When this returns, the server has obeyed all that the program has written, and what it has answered on
// these streams can be read. Only those that the program looks at: on a connection that nobody reads the
// kernel holds bytes back, and waiting for them would cost 40 ms each time.
void catch_up(std::uint64_t streams);

// True if no program has written to a bus since its last catch_up(), and no bus is a TCP connection.
bool is_settled();

// The kernel's worker carries over what the server has written to a pseudo terminal; poll() waits for it.
void bring_in(int fd);

// How many bytes can be read; -1: the kernel does not say.
int available_bytes(int fd);

void note_connected(int fd);
void note_written(const Descriptor& to, std::int64_t count);
void note_read(const Descriptor& from, std::int64_t count);

// The part of an epoll set that leads to buses. Asks the kernel each time: sockets are added before they
// connect.
struct WatchedBuses {
  bool any = false;
  std::uint64_t streams = 0;  // as bits
};
WatchedBuses watched_buses(int epoll);

}  // namespace visum::shim
