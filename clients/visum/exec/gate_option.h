// --gate of `visum exec`: what ends a cycle of a program that asks and is answered (grade L1).
#pragma once

#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::exec {

// "bus", "bus:PART", "bus:PART=MODULE:BYTES" (bytes as hex digits: "bus:arm=7:0B10"), "ports" or
// "ports:CLIENT". A part or client that is not named is empty. Throws ExitError(kUsage).
struct GateOption {
  bool on_bus = true;
  protocol::Gate gate;
};
GateOption parse_gate(const std::string& text);

// With the part or client filled in: the only part that has a bus, or `program`. Throws ExitError(kUsage).
protocol::Gate gate_of(const GateOption& option, const std::vector<protocol::PartBus>& buses,
                       const std::string& program);

}  // namespace visum::exec
