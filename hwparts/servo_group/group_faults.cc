#include "hwparts/servo_group/group_faults.h"

#include <algorithm>

namespace visum::servo_group {
namespace {

using hwparts::Fault;
using hwparts::FaultKind;

void break_drive(const Fault& fault, drive::Broken& broken) {
  const double number = fault.numbers[1];  // [0] is which drive
  switch (fault.kind) {
    case FaultKind::kEncoderStuck:
      broken.encoder_stuck = true;
      return;
    case FaultKind::kEncoderOffset:
      broken.encoder_offset = number;
      return;
    case FaultKind::kEncoderNoise:
      broken.encoder_deviation = number;
      return;
    case FaultKind::kTorqueLost:
      broken.torque_share = 1.0 - number;
      return;
    case FaultKind::kBrakeStuck:
      broken.brake = number >= 0.5 ? drive::BrakeFault::kStuckClosed : drive::BrakeFault::kStuckOpen;
      return;
    case FaultKind::kGearSlip:
      broken.slip_effort = number;
      return;
    case FaultKind::kOverTemperature:
      broken.least_winding = number;
      return;
    default:
      return;
  }
}

}  // namespace

GroupFaults group_faults(std::span<const hwparts::ActiveFault> faults) {
  GroupFaults all;
  for (const auto& active : faults) {
    const double number = active.fault.numbers[0];
    switch (active.fault.kind) {
      case FaultKind::kSupplyDip:
        all.most_supply_v = number;
        break;
      case FaultKind::kEmergencyStop:
        all.emergency_stop = true;
        break;
      case FaultKind::kBusLost:
        all.bus.lost = number;
        break;
      case FaultKind::kBusLate:
        all.bus.late_ns = static_cast<std::int64_t>(number * 1e6);
        break;
      case FaultKind::kBusDoubled:
        all.bus.doubled = number;
        break;
      case FaultKind::kBusCorrupted:
        all.bus.corrupted = number;
        break;
      default:
        break;
    }
  }
  return all;
}

drive::Broken broken_of(std::span<const hwparts::ActiveFault> faults, std::size_t drive) {
  drive::Broken broken;
  for (const auto& active : faults) {
    const bool of_drive = hwparts::fault_info(active.fault.kind).target == hwparts::FaultTarget::kDrive;
    if (of_drive && active.fault.drive() == drive) break_drive(active.fault, broken);
  }
  return broken;
}

std::optional<std::string> refuse(const Fault& fault, const drive::DriveData& data) {
  if (fault.kind == FaultKind::kBrakeStuck && !data.brake.present) return "has no brake";
  if (fault.kind == FaultKind::kGearSlip && data.gear.stiffness == 0.0)
    return "has a rigid gear, which cannot slip";
  if (fault.kind == FaultKind::kGearSlip && fault.numbers[1] >= data.gear.breaking_effort)
    return "carries no more than " + std::to_string(data.gear.breaking_effort) + " anyway";
  return std::nullopt;
}

}  // namespace visum::servo_group
