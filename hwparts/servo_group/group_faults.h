// Translates the faults that act into the faults of a group's drives, supply and bus. Pure functions.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>

#include "hwparts/drive/broken.h"
#include "hwparts/drive/drive_data.h"
#include "hwparts/fault_set.h"
#include "hwparts/powercube/bus_faults.h"

namespace visum::servo_group {

// The faults of the group as a whole.
struct GroupFaults {
  bool emergency_stop = false;
  double most_supply_v = std::numeric_limits<double>::infinity();
  powercube::BusFaults bus;
};
GroupFaults group_faults(std::span<const hwparts::ActiveFault> faults);

// The faults of one of its drives, counted from 0.
drive::Broken broken_of(std::span<const hwparts::ActiveFault> faults, std::size_t drive);

// The reason why `fault` cannot act on a drive with this data; nothing if it can.
std::optional<std::string> refuse(const hwparts::Fault& fault, const drive::DriveData& data);

}  // namespace visum::servo_group
