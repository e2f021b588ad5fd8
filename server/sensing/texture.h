// Pictures on surfaces: read from PNG and JPEG files, laid on shapes as the page lays them, and sampled
// between their pixels in fixed arithmetic, so that a camera sees the same on every machine.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/scene/looks.h"
#include "server/world/world_model.h"

namespace visum::sensing {

class Texture {
 public:
  // Throws ConfigError that names the picture's file where it cannot be read.
  explicit Texture(const scene::Texture& file);

  // Red, green and blue at a place in tiles: u to the right and v up, from the lower left corner of a tile. 1
  // is white; between the four nearest pixels, and on and on in both directions.
  Eigen::Vector3d at(double u, double v) const;

 private:
  Eigen::Vector3d pixel(int column, int row) const;

  int width_ = 0, height_ = 0;
  std::vector<std::uint8_t> rgb_;  // row by row from the top
};

// Where a point of a shape's surface is on a picture that lies on it, in m from the picture's lower left
// corner. Both in the shape's frame. None: the shape has no such coordinates (convex, mesh).
std::optional<std::array<double, 2>> place_on(const world::Shape& shape, const Eigen::Vector3d& p_S,
                                              const Eigen::Vector3d& normal_S);

inline constexpr int kMaxTextureSide = 16'384;
inline constexpr int kMaxTexels = 16'777'216;

}  // namespace visum::sensing
