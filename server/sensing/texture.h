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
  // is white; between the four nearest pixels, and on and on in both directions. `across`: how much of a tile
  // the viewer's pixel covers; where that is more than a pixel of the picture, smaller copies of it answer.
  Eigen::Vector3d at(double u, double v, double across = 0.0) const;

 private:
  // The picture, or a copy of half the size of the one before.
  struct Level {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  // row by row from the top
  };
  static Eigen::Vector3d pixel(const Level& level, int column, int row);
  static Eigen::Vector3d between(const Level& level, double u, double v);
  static Level half_of(const Level& level);

  std::vector<Level> levels_;  // down to one pixel
};

// Where a point of a shape's surface is on a picture that lies on it, in m from the picture's lower left
// corner. Both in the shape's frame. None: the shape has no such coordinates (convex, mesh).
std::optional<std::array<double, 2>> place_on(const world::Shape& shape, const Eigen::Vector3d& p_S,
                                              const Eigen::Vector3d& normal_S);

inline constexpr int kMaxTextureSide = 16'384;
inline constexpr int kMaxTexels = 16'777'216;

}  // namespace visum::sensing
