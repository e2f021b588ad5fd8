// The host's end of a bus: what a program that drives modules has in hand. Real ones are opened by
// server/bus/host_connection.h; tests plug modules in directly. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hwparts/powercube/message.h"
#include "hwparts/powercube/module.h"

namespace visum::powercube {

class BusConnection {
 public:
  virtual ~BusConnection() = default;

  virtual std::string name() const = 0;  // "serial:/dev/ttyUSB0,38400"
  virtual BusFraming framing() const = 0;

  // False while the device is gone: what is sent is lost. It comes up again by itself where it can, as long
  // as somebody receives.
  virtual bool up() const = 0;
  // Neither waits.
  virtual void send(const Telegram& telegram) = 0;
  virtual std::optional<Telegram> receive() = 0;

  // A steady clock, and waiting on it: until `due_ns`, or until something can be received.
  virtual std::int64_t now_ns() const = 0;
  virtual void wait_until(std::int64_t due_ns) = 0;
};

}  // namespace visum::powercube
