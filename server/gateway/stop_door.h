// The door for emergency stops: a UDP socket at the address and port of the sessions, with a thread of its
// own. It shares no queue, no lock and no log with clients, so that none of them can hold a stop up. Only
// where models come or go does the tick's thread tell it the names of the parts.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "server/gateway/stop_orders.h"

namespace visum::gateway {

class StopDoor {
 public:
  // Opens the door and starts its thread. Throws std::runtime_error that names address and port, where
  // another program has that port.
  StopDoor(const std::string& address, std::uint16_t port, StopOrders orders);
  ~StopDoor();
  StopDoor(const StopDoor&) = delete;
  StopDoor& operator=(const StopDoor&) = delete;

  // Any thread: other parts are there from now on, with these names by number. They are known before the
  // next datagram is read.
  void set_parts(std::vector<std::string> parts);

 private:
  void run();
  void serve_some();
  void send(const std::string& peer, const protocol::StopDatagram& datagram) const;

  StopOrders orders_;                              // the thread's
  std::mutex mutex_;                               // guards parts_
  std::optional<std::vector<std::string>> parts_;  // that orders_ does not know yet
  int socket_ = -1;
  int end_ = -1;  // an eventfd: readable once the thread shall end
  std::thread thread_;
};

}  // namespace visum::gateway
