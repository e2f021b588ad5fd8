// Reads the basic values of scene files: names, vectors, poses, colours, paths. All functions throw
// ConfigError at the value's own place.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <string>

#include "protocol/config/config.h"
#include "server/world/world_model.h"

namespace visum::scene {

// Lengths, positions and speeds beyond 1e6 are typing errors, not scenes.
inline constexpr config::Range kPlaceable{-1e6, 1e6};
inline constexpr config::Range kSize{0.0, 1e6, true};

inline constexpr std::size_t kMaxNameBytes = 128;

// Says why `name` is not a valid name in a scene ("is empty", "holds a '/'"); empty if it is.
std::string name_fault(const std::string& name);
std::string yaml_quoted(const std::string& text);  // as a text of YAML
std::string read_name(const config::Node& node);

Eigen::Vector3d read_vector(const config::Node& node, config::Range range = kPlaceable);

// Reads {xyz: [m], rpy: [rad]} or {xyz: [m], wxyz: [unit quaternion]}; each key may be left out.
world::Pose read_pose(const config::Node& node);
// As read_pose(), but allows a key `in`, which the caller reads (frames.h).
world::Pose read_pose_in(const config::Node& node);
world::Pose read_pose_or_identity(const config::Node& map, std::string_view key);

// Roll, pitch, yaw about fixed axes, as in URDF: R = Rz(yaw) Ry(pitch) Rx(roll).
Eigen::Quaterniond quaternion_from_rpy(const Eigen::Vector3d& rpy);

// Reads [r, g, b] or [r, g, b, a], each 0 to 1.
std::array<double, 4> read_color(const config::Node& node);

// Reads a direction of any length but zero and makes it a unit vector.
Eigen::Vector3d read_axis(const config::Node& node);

// Reads a file name, relative to the folder of the file that names it. URLs are refused, because loading a
// scene uses no network.
std::filesystem::path read_path(const config::Node& node);

}  // namespace visum::scene
