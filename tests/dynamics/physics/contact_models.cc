#include "tests/dynamics/physics/contact_models.h"

#include <algorithm>
#include <cmath>

#include "tests/dynamics/model_builder.h"

namespace visum::physics {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;

namespace {

constexpr double kEdge = 0.2;           // m, of every cube
constexpr double kBrick = 2.0 * kEdge;  // length of a brick; its other edges are kEdge

ModelBuilder on_a_plane(const world::EngineSetting& engine, double tick_s) {
  ModelBuilder builder(engine);
  builder.model.tick_ns = std::llround(1e9 * tick_s);
  builder.add_ground();
  return builder;
}

void add_cube(ModelBuilder& builder, const world::Pose& X_WB) {
  builder.add_box("box_" + std::to_string(builder.model.bodies.size()), Eigen::Vector3d::Constant(kEdge), 1.0,
                  X_WB);
}

// In -1..1: the fractional part of multiples of an irrational number, spread evenly.
double scattered(int i, double irrational) {
  const double x = irrational * (i + 1);
  return 2.0 * (x - std::floor(x)) - 1.0;
}

// Layers of as many cubes as make the heap about as high as wide.
void add_pile(ModelBuilder& builder, int boxes, double x) {
  constexpr double kAcross = 0.32, kUp = 0.35, kShift = 0.05, kTilt = 0.3;  // m, rad
  const int side = std::max(1, static_cast<int>(std::lround(std::cbrt(0.7 * boxes))));
  for (int i = 0; i < boxes; ++i) {
    const int layer = i / (side * side), place = i % (side * side);
    const double dx = kAcross * (place % side - 0.5 * (side - 1)) + kShift * scattered(i, 0.6180339887);
    const double dy = kAcross * (place / side - 0.5 * (side - 1)) + kShift * scattered(i, 0.4142135624);
    add_cube(builder, at(x + dx, dy, 0.2 + kUp * layer, kTilt * scattered(i, 0.7320508076),
                         {scattered(i, 0.2360679775), scattered(i, 0.6457513111), 1.0}));
  }
}

}  // namespace

world::WorldModel stack(const world::EngineSetting& engine, double tick_s, int count, double top_mass_kg) {
  ModelBuilder builder = on_a_plane(engine, tick_s);
  for (int i = 0; i < count; ++i)
    builder.add_box("box_" + std::to_string(i), Eigen::Vector3d::Constant(kEdge),
                    i == count - 1 ? top_mass_kg : 1.0, at(0.0, 0.0, kEdge * (i + 0.5) - kTouch * (i + 1)));
  return builder.model;
}

world::WorldModel towers(const world::EngineSetting& engine, double tick_s, int count, int height) {
  ModelBuilder builder = on_a_plane(engine, tick_s);
  const int side = static_cast<int>(std::ceil(std::sqrt(count)));
  for (int i = 0; i < count; ++i)
    for (int k = 0; k < height; ++k)
      add_cube(builder, at(i % side, i / side, kEdge * (k + 0.5) - kTouch * (k + 1)));
  return builder.model;
}

world::WorldModel standing_wall(const world::EngineSetting& engine, double tick_s, int side) {
  ModelBuilder builder = on_a_plane(engine, tick_s);
  for (int row = 0; row < side; ++row) {
    const bool shifted = row % 2 == 1;
    double end = 0.0;  // of the bricks that lie already, m
    for (int i = 0; i < side + (shifted ? 1 : 0); ++i) {
      const bool half = shifted && (i == 0 || i == side);
      const double length = half ? 0.5 * kBrick : kBrick;
      builder.add_box("brick_" + std::to_string(row) + "_" + std::to_string(i), {length, kEdge, kEdge},
                      half ? 0.5 : 1.0,
                      at(end + 0.5 * length, 0.0, kEdge * (row + 0.5) - kTouch * (row + 1)));
      end += length;
    }
  }
  return builder.model;
}

world::WorldModel falling_wall(const world::EngineSetting& engine, double tick_s, int side) {
  constexpr double kGap = 1e-3;  // m
  ModelBuilder builder = on_a_plane(engine, tick_s);
  for (int row = 0; row < side; ++row)
    for (int i = 0; i < side; ++i)
      builder.add_box(
          "brick_" + std::to_string(row * side + i), {kBrick, kEdge, kEdge}, 1.0,
          at((kBrick + kGap) * (i + 0.5 * (row % 2)), 0.0, kEdge * (row + 0.5) - kTouch * (row + 1)));
  return builder.model;
}

world::WorldModel piles(const world::EngineSetting& engine, double tick_s, int count, int boxes,
                        double pitch) {
  ModelBuilder builder = on_a_plane(engine, tick_s);
  for (int i = 0; i < count; ++i) add_pile(builder, boxes, pitch * i);
  return builder.model;
}

}  // namespace visum::physics
