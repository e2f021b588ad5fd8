// Parses the options of `visum exec` that name buses, and matches them with the buses of a server.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clients/visum/exec/bus_of.h"
#include "clients/visum/exec/device_place.h"
#include "protocol/messages.h"

namespace visum::exec {

struct TtyOption {
  std::string device, part;  // "/dev/ttyS0", "arm"
};
// "ttyS0=arm" or "/dev/ttyS0=arm". Throws ExitError(kUsage).
TtyOption parse_tty(const std::string& text);

struct CanOption {
  std::string vendor, part;  // "esd" or "peak"; an empty part means the only one that has a bus
};
// "esd" or "esd=arm". Throws ExitError(kUsage).
CanOption parse_can(const std::string& text);

struct BusOption {
  std::string part, kind;  // "pty", "slcan" or "tcp"
};
// "arm=pty". Throws ExitError(kUsage).
BusOption parse_bus(const std::string& text);
// As `visumd --bus` takes it: "arm=pty:FOLDER/arm.tty", "arm=slcan:FOLDER/arm.can", "arm=tcp:0".
std::string bus_address(const std::string& part, const std::string& kind,
                        const std::filesystem::path& folder);

// The devices of the parts' buses on this machine. Throws ExitError.
std::vector<Placement> placements_of(const std::vector<TtyOption>& ttys,
                                     const std::vector<protocol::PartBus>& buses, Advice advice);
// The part whose bus it is; where the option names none, the first that has one.
std::string part_of_can(const CanOption& can, const std::vector<protocol::PartBus>& buses);
// Puts our replacement of the vendor's library into the environment: the loader finds it before the vendor's
// own, and it knows where the bus is. Buses are on the server's loopback, so the program must run there too.
void lead_can(const CanOption& can, const std::vector<protocol::PartBus>& buses, Advice advice);

}  // namespace visum::exec
