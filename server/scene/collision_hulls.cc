#include "server/scene/collision_hulls.h"

namespace visum::scene {

std::size_t take_hulls(Draft& draft, std::vector<world::Shape>& shapes, const config::Place& place) {
  std::vector<world::Shape> looks;
  std::size_t replaced = 0;
  for (world::Shape& shape : shapes) {
    if (shape.kind != world::ShapeKind::kMesh || !shape.collides) continue;
    const world::MeshId hull = draft.hull_of(shape.mesh, place);
    if (!hull.valid()) continue;
    if (shape.color[3] > 0.0) {
      looks.push_back(shape);
      looks.back().collides = false;
      shape.color[3] = 0.0;
    }
    shape.kind = world::ShapeKind::kConvex;
    shape.mesh = hull;
    ++replaced;
  }
  shapes.insert(shapes.end(), looks.begin(), looks.end());
  return replaced;
}

}  // namespace visum::scene
