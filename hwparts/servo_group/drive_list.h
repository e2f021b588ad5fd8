// The drives of a part: its drives file, bound to the joints that the scene gives to the part.
//
//   source: where the figures are from      # shown on the blackboard `Identity`
//   drives:
//     - joints: [joint_1]                   # one, or several that move alike (a gripper's fingers)
//       type: PRL120
//       module: 1
//       motor: ...                          # every key: drive_data.cc; an example:
//                                           # models/amtec_arm/drives.yaml
//
// The order in this file is the order of the ports. An entry for joints that the part does not have belongs
// to another part and is skipped.
#pragma once

#include <string>
#include <vector>

#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/gear.h"
#include "hwparts/part.h"

namespace visum::servo_group {

struct DriveEntry {
  drive::DriveData data;
  std::vector<std::size_t> joints;  // indices into PartContext::joints
  double initial_position = 0.0;    // module's coordinate: the sum of its joints' positions
  drive::Load load;
};

struct DriveList {
  std::string source;
  std::vector<DriveEntry> drives;
};

inline constexpr std::size_t kMaxDrives = 64;

// Reads the file that the part's key `drives` names. Throws ConfigError for a joint without a drive or with
// two, fingers that start apart, a start outside of the hard limits, gains too high for the tick, and
// everything that read_drive_data() refuses.
DriveList load_drives(const hwparts::PartContext& context);

}  // namespace visum::servo_group
