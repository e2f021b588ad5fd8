// Where a part's bus can be reached: "PART=KIND:WHERE[,baud=N][,delay_ms=X]" on the command line, the same
// without "PART=" under the part's key `bus` in the scene, one or a list.
//
//   arm=pty:arm.tty           RS-232 on a pseudo terminal, with a link to it at that path
//   arm=tcp:4001              RS-232 or slcan over TCP on loopback; 0: any free port
//   arm=slcan:arm.can         CAN frames as text on a pseudo terminal
//   arm=socketcan:can0        a CAN interface of the kernel
//
// `baud` (bit/s) and `delay_ms` (of each answer) model the line, in simulated time; without them the line is
// ideal. Relative paths start where the daemon was started.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/scene/scene.h"

namespace visum::bus {

struct BusTiming {
  double baud = 0.0;  // bit/s; 0: takes no time
  std::int64_t delay_ns = 0;
  bool ideal() const { return baud == 0.0 && delay_ns == 0; }
};

struct BusAddress {
  std::string part;
  std::string kind;   // a row of bus_kinds()
  std::string where;  // what its `open` takes
  BusTiming timing;
};

// The open buses by part, as the ready line shows them: "pty:arm.tty", "tcp:40123".
using BusNames = std::map<std::string, std::vector<std::string>>;

inline constexpr std::size_t kMaxBusLinks = 32;

// "=tcp:0" leaves the part open: Buses takes the only one that has modules, and adds nothing where a part has
// a bus of that kind already. Throws std::runtime_error for any other text, or for a part that the scene does
// not have.
BusAddress parse_bus(const std::string& text, const scene::Scene& scene);
// The addresses under the key `bus` of the scene's parts. Throws ConfigError.
std::vector<BusAddress> scene_buses(const scene::Scene& scene);

}  // namespace visum::bus
