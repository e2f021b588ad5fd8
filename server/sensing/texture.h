// Textures: pictures from PNG and JPEG files, laid on shapes as the page lays them. They are sampled between
// their pixels with fixed arithmetic, so that a camera sees the same on every machine. Immutable once made;
// any thread.
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
  // Throws a ConfigError that names the picture's file where the picture cannot be read.
  explicit Texture(const scene::Texture& file);

  // Red, green and blue (1 is white), interpolated between the four nearest pixels. The place is counted in
  // tiles from the lower left corner of one: u to the right, v up; tiles repeat in both directions. `across`:
  // how much of a tile the viewer's pixel covers. Where that is more than one pixel of the picture, smaller
  // copies are sampled.
  Eigen::Vector3d at(double u, double v, double across = 0.0) const;

 private:
  // The picture, or a copy with half the size of the level before.
  struct Level {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  // row by row from the top
  };
  // Columns and rows outside of the picture wrap around.
  static Eigen::Vector3d pixel(const Level& level, int column, int row);
  static Eigen::Vector3d between(const Level& level, double u, double v);
  static Level half_of(const Level& level);

  std::vector<Level> levels_;  // down to one pixel
};

// Where on its picture a point of a shape's surface is, in m from the picture's lower left corner. Point and
// normal are in the shape's frame. Nothing: shapes of this kind (convex, mesh) have no such coordinates.
std::optional<std::array<double, 2>> place_on(const world::Shape& shape, const Eigen::Vector3d& p_S,
                                              const Eigen::Vector3d& normal_S);

inline constexpr int kMaxTextureSide = 16'384;
inline constexpr int kMaxTexels = 16'777'216;

}  // namespace visum::sensing
