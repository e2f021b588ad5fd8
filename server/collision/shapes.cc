#include "server/collision/shapes.h"

#include "server/collision/hull.h"

namespace visum::collision {
namespace {

Convex make_convex_of(const world::WorldModel& model, const world::Shape& shape) {
  switch (shape.kind) {
    case world::ShapeKind::kBox:
      return make_convex(make_box({shape.size[0], shape.size[1], shape.size[2]}));
    case world::ShapeKind::kSphere:
      return make_round(shape.size[0], 0.0);
    case world::ShapeKind::kCylinder:
      return make_cylinder(shape.size[0], shape.size[1]);
    case world::ShapeKind::kCapsule:
      return make_round(shape.size[0], shape.size[1]);
    case world::ShapeKind::kConvex:
      return make_convex(make_hull(model.meshes[shape.mesh.index()].vertices));
    case world::ShapeKind::kPlane:
    case world::ShapeKind::kMesh:
      break;
  }
  return {};
}

Eigen::AlignedBox3d box_of(const Convex& convex) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < 3; ++i) {
    box.max()[i] = convex.farthest(Eigen::Vector3d::Unit(i))[i];
    box.min()[i] = convex.farthest(-Eigen::Vector3d::Unit(i))[i];
  }
  return box;
}

Eigen::AlignedBox3d box_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const MeshTriangle& triangle : mesh.triangles()) {
    for (const Eigen::Vector3d& corner : triangle.corners) box.extend(corner);
  }
  return box;
}

PreparedShape prepare(const world::WorldModel& model, world::ShapeId id) {
  const world::Shape& shape = model.shapes[id.index()];
  const world::Surface& surface = model.surfaces[shape.surface.index()];
  PreparedShape prepared;
  prepared.id = id;
  prepared.body = shape.body;
  prepared.kind = shape.kind;
  prepared.fixed = model.bodies[shape.body.index()].fixed;
  prepared.X_BS = shape.X_BS;
  prepared.friction = surface.friction;
  prepared.restitution = surface.restitution;
  prepared.rolling_friction = surface.rolling_friction;
  prepared.torsional_friction = surface.torsional_friction;
  if (shape.kind == world::ShapeKind::kMesh) {
    prepared.mesh = std::make_unique<Mesh>(model.meshes[shape.mesh.index()]);
    prepared.box_S = box_of(*prepared.mesh);
  } else if (shape.kind != world::ShapeKind::kPlane) {
    prepared.convex = make_convex_of(model, shape);
    prepared.gjk = std::make_unique<GjkShape>(prepared.convex);
    prepared.box_S = box_of(prepared.convex);
  }
  return prepared;
}

}  // namespace

Eigen::AlignedBox3d box_around(const Eigen::AlignedBox3d& box, const Eigen::Matrix3d& R,
                               const Eigen::Vector3d& p) {
  const Eigen::Vector3d center = R * box.center() + p;
  const Eigen::Vector3d half = R.cwiseAbs() * (0.5 * box.sizes());
  return {center - half, center + half};
}

std::vector<PreparedShape> prepare_shapes(const world::WorldModel& model) {
  std::vector<PreparedShape> shapes;
  for (std::size_t i = 0; i < model.shapes.size(); ++i) {
    if (model.shapes[i].collides) shapes.push_back(prepare(model, {static_cast<std::int32_t>(i)}));
  }
  return shapes;
}

void place(PreparedShape& shape, const world::WorldModel& model, const world::WorldState& state) {
  const world::Pose X_WS =
      link_pose(model.bodies[shape.body.index()], state.bodies[shape.body.index()]) * shape.X_BS;
  shape.placed = {&shape.convex, shape.gjk.get(), X_WS.q.toRotationMatrix(), X_WS.p};
  shape.box_W.setEmpty();
  if (shape.placed.p.allFinite() && shape.placed.R.allFinite() && !shape.box_S.isEmpty())
    shape.box_W = box_around(shape.box_S, shape.placed.R, shape.placed.p);
}

}  // namespace visum::collision
