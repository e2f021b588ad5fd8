// The host's end of a bus, as a device of this machine. visum-hwpart drives real modules with it.
//
//   serial:/dev/ttyUSB0,38400     RS-232; bit rate 1200 to 115200
//   tcp:HOST:PORT, tcp:PORT       RS-232 behind a device server; without HOST on this machine
//   slcan:/dev/ttyACM0[,500]      CAN behind a serial adapter (Lawicel); kbit/s
//   socketcan:can0                a CAN interface of the kernel, up and at its bit rate
#pragma once

#include <memory>
#include <string>

#include "hwparts/powercube/bus_connection.h"

namespace visum::bus {

// Opens a bus. When its device goes away, it is tried again twice a second. Throws std::runtime_error that
// says what is wrong with the text, or what cannot be opened and why.
std::unique_ptr<powercube::BusConnection> open_host_connection(const std::string& text);

}  // namespace visum::bus
