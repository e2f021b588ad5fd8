// Shared by the repairs of URDF and SDF files: the order of moments, and inertias made physical.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>

namespace visum::scene {

inline constexpr double kMinSizeM = 1e-6;  // of a shape, as world::find_fault wants it
// Moments count as those of a solid within this share.
inline constexpr double kMomentTolerance = 1e-15;

// The moments as both formats name them, and their places in the matrix.
inline constexpr std::array<const char*, 6> kMoments = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
inline constexpr std::array<std::pair<int, int>, 6> kMomentPlaces = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

// The least change that makes positive moments those of a solid: it raises the two smaller ones alike until
// A + B = C. Nothing if one is not positive.
std::optional<Eigen::Matrix3d> as_solid(const Eigen::Matrix3d& inertia);

}  // namespace visum::scene
