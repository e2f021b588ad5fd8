#include <array>

#include "server/bus/bus_link.h"

namespace visum::bus {
namespace {

constexpr std::array<BusKind, 4> kKinds{{
    {"pty", "RS-232 on a pseudo terminal, linked from a path", open_pty},
    {"tcp", "RS-232 or slcan over TCP on loopback", open_tcp},
    {"slcan", "CAN frames as text on a pseudo terminal, linked from a path", open_slcan},
    {"socketcan", "a CAN interface of the kernel", open_socketcan},
}};

}  // namespace

std::span<const BusKind> bus_kinds() {
  return kKinds;
}

}  // namespace visum::bus
