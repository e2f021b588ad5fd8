// Compares the modules on a bus with the part's configuration. This comes before anything else is done with
// real modules. It moves nothing. Runs on the caller's thread and waits for the bus.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hwparts/drive/drive_data.h"
#include "hwparts/powercube/asker.h"

namespace visum::bus_group {

// One module as the configuration has it.
struct Expected {
  drive::DriveData data;
  std::optional<std::uint32_t> serial_number;  // nothing: any number will do
};

// One module as the survey found it. [u] is rad or m.
struct Found {
  std::uint16_t firmware = 0;
  std::uint32_t serial_number = 0;
  std::uint32_t state = 0;
  double position = 0.0;  // [u]
  // The message that armed its watchdog, if wanted. It must be sent again to a module that was without
  // supply.
  std::optional<powercube::Message> watchdog;
};

// Finds the modules, gives them their limits (soft limits, speed, acceleration, current), arms their watchdog
// if wanted, and reads them. Returns them in the order of `expected`. Takes up to some seconds. Throws
// std::runtime_error that names every module that is missing, is of the wrong kind, has another serial
// number, is moving, or does not take its limits.
std::vector<Found> survey(powercube::Asker& asker, std::span<const Expected> expected, bool watchdog);

// The messages that give a module its limits. They must be sent again to a module that was without supply.
std::vector<powercube::Message> limit_settings(const drive::DriveData& data);

}  // namespace visum::bus_group
