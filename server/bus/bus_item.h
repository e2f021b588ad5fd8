// A telegram on its way between a bus and its modules. A plain value.
#pragma once

#include <cstdint>

#include "hwparts/powercube/module.h"

namespace visum::bus {

struct BusItem {
  std::uint32_t link = 0;     // it came, or goes, by this one
  std::uint64_t channel = 0;  // by number; answers to CAN go to all CAN channels of the link's part
  powercube::BusFraming framing = powercube::BusFraming::kSerial;
  powercube::Telegram telegram;
  // One bit of this answer is flipped on its way. On CAN the receivers drop such a frame.
  bool corrupted = false;
};

}  // namespace visum::bus
