// What a descriptor leads to, as far as waiting on it goes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "clients/shim/channel.h"

namespace visum::shim {

struct Descriptor {
  bool can_wait = false;  // no file or folder
  bool is_socket = false;
  bool is_tty = false;       // of a bus
  Stream* stream = nullptr;  // to a bus, over TCP
  bool is_session = false;   // the ports over TCP: the server answers at once, in real time
  bool on_bus() const { return is_tty || stream != nullptr; }
};
// Asks the kernel each time: descriptors change hands in ways that nobody sees.
Descriptor descriptor(int fd);

// All that the server has said by now to what the program has written can be read when this returns.
void catch_up();

// The kernel's worker carries over what the server has written to a pseudo terminal; poll() waits for it.
void bring_in(int fd);

// How many bytes can be read; -1: the kernel does not say.
int available_bytes(int fd);

void note_connected(int fd);
void note_written(const Descriptor& to, std::int64_t count);
void note_read(const Descriptor& from, std::int64_t count);

// epoll: whether a set holds something on a bus. Asks the kernel, too: sockets are added before they connect.
bool watches_bus(int epoll);

}  // namespace visum::shim
