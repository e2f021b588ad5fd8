// The door for emergency stops: a UDP socket at the address and port of the sessions, with a thread of its
// own. It shares no queue, no lock and no log with clients, so that none of them can hold a stop up.
#pragma once

#include <cstdint>
#include <string>
#include <thread>

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

 private:
  void run();
  void serve_some();
  void send(const std::string& peer, const protocol::StopDatagram& datagram) const;

  StopOrders orders_;  // the thread's
  int socket_ = -1;
  int end_ = -1;  // an eventfd: readable once the thread shall end
  std::thread thread_;
};

}  // namespace visum::gateway
