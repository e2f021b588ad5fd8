// Places in the world: the origin of the file that is being read, which an including file may place anywhere,
// and the frames that a scene names under `frames:`. All functions throw ConfigError.
#pragma once

#include <string_view>

#include "server/scene/draft.h"

namespace visum::scene {

inline constexpr std::size_t kMaxFrames = 10'000;

// Reads an entry of `frames:`, {name, pose}.
void read_frame(Draft& draft, const config::Node& entry);

// Reads a pose of `map` and returns it in W. {xyz, rpy or wxyz} counts from the file's origin, or with `in:
// NAME` from that frame. If the key is missing, the pose is the file's origin.
world::Pose read_world_pose(const Draft& draft, const config::Node& map, std::string_view key);

// From the file's origin to W. In a file that was not placed elsewhere, the numbers keep every bit.
Eigen::Vector3d point_in_world(const Draft& draft, const Eigen::Vector3d& point);
Eigen::Vector3d direction_in_world(const Draft& draft, const Eigen::Vector3d& direction);

}  // namespace visum::scene
