// A telegram on its way between a bus and its modules. A plain value.
#pragma once

#include <cstdint>

#include "hwparts/powercube/module.h"

namespace visum::bus {

struct BusItem {
  std::uint32_t link = 0;     // by which it came, or by which it goes
  std::uint64_t channel = 0;  // by number; answers to CAN go to all CAN channels of the link's part
  powercube::BusFraming framing = powercube::BusFraming::kSerial;
  powercube::Telegram telegram;
  // An answer of which a bit is turned over on its way. On CAN the receivers throw such a frame away.
  bool corrupted = false;
};

}  // namespace visum::bus
