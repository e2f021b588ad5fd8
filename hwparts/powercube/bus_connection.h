// The host's end of a bus, for a program that drives modules. server/bus/host_connection.h opens real ones;
// tests plug modules in directly. The program owns it and uses it from one thread. A device that is gone is
// no error: up() tells.
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

  // False while the device is gone; sent telegrams are lost then. Where it can, it comes up again by itself,
  // as long as receive() is called.
  virtual bool up() const = 0;
  // send() and receive() do not wait.
  virtual void send(const Telegram& telegram) = 0;
  virtual std::optional<Telegram> receive() = 0;

  // A steady clock, and waiting on it: until `due_ns`, or until a telegram can be received.
  virtual std::int64_t now_ns() const = 0;
  virtual void wait_until(std::int64_t due_ns) = 0;
};

}  // namespace visum::powercube
