// What stands on a bus, compared with what the part's configuration says: the first thing that is done with
// real modules. Nothing is moved.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hwparts/drive/drive_data.h"
#include "hwparts/powercube/asker.h"

namespace visum::bus_group {

// One module as it is to be.
struct Expected {
  drive::DriveData data;
  std::optional<std::uint32_t> serial_number;  // none: any
};

// One module as it was found. [u] is rad or m.
struct Found {
  std::uint16_t firmware = 0;
  std::uint32_t serial_number = 0;
  std::uint32_t state = 0;
  double position = 0.0;  // [u]
  // What armed it, if wanted: to be sent again to one that was without supply.
  std::optional<powercube::Message> watchdog;
};

// Finds the modules, gives them their limits (soft limits, speed, acceleration, current), arms the watchdog
// if wanted, and reads them. In the order of `expected`. Waits for the bus: up to some seconds. Throws
// std::runtime_error that names every module that is missing, of the wrong kind, of another serial number,
// moving, or that does not take its limits.
std::vector<Found> survey(powercube::Asker& asker, std::span<const Expected> expected, bool watchdog);

// What gives a module its limits: to be sent again to one that was without supply.
std::vector<powercube::Message> limit_settings(const drive::DriveData& data);

}  // namespace visum::bus_group
