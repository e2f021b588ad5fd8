// Opens the devices that host_connection.h names. Each function throws std::runtime_error that says what
// cannot be opened and why.
#pragma once

#include <memory>
#include <string>

#include "server/bus/channel.h"

namespace visum::bus {

std::unique_ptr<Channel> open_serial_device(const std::string& where);      // "/dev/ttyUSB0,38400"
std::unique_ptr<Channel> open_slcan_device(const std::string& where);       // "/dev/ttyACM0,500"
std::unique_ptr<Channel> connect_to_bus(const std::string& where);          // "HOST:PORT" or "PORT"
std::unique_ptr<Channel> open_can_interface(const std::string& interface);  // "can0"

}  // namespace visum::bus
