#include "tests/dynamics/physics/contact_models.h"

#include <cmath>

#include "tests/dynamics/model_builder.h"

namespace visum::physics {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;

world::WorldModel stack(const world::EngineSetting& engine, double tick_s, int count, double top_mass_kg) {
  constexpr double kEdge = 0.2;
  ModelBuilder builder(engine);
  builder.model.tick_ns = std::llround(1e9 * tick_s);
  builder.add_ground();
  for (int i = 0; i < count; ++i)
    builder.add_box("box_" + std::to_string(i), Eigen::Vector3d::Constant(kEdge),
                    i == count - 1 ? top_mass_kg : 1.0, at(0.0, 0.0, kEdge * (i + 0.5) - kTouch * (i + 1)));
  return builder.model;
}

}  // namespace visum::physics
