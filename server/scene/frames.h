// Places in the world: of the file that is being read, whose origin may be put anywhere by who includes it,
// and those that scenes give a name to under `frames:`.
#pragma once

#include <string_view>

#include "server/scene/draft.h"

namespace visum::scene {

inline constexpr std::size_t kMaxFrames = 10'000;

// One entry of `frames:`, {name, pose}.
void read_frame(Draft& draft, const config::Node& entry);

// `map`'s pose as a pose in W: {xyz, rpy or wxyz} from the file's origin, or, with `in: NAME`, from that
// frame. A missing pose is the file's origin.
world::Pose read_world_pose(const Draft& draft, const config::Node& map, std::string_view key);

// From the file's origin to W. A file that nobody put elsewhere keeps every bit.
Eigen::Vector3d point_in_world(const Draft& draft, const Eigen::Vector3d& point);
Eigen::Vector3d direction_in_world(const Draft& draft, const Eigen::Vector3d& direction);

}  // namespace visum::scene
