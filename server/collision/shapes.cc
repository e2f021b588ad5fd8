#include "server/collision/shapes.h"

#include "server/collision/hull.h"

namespace visum::collision {
namespace {

// Makes a mesh, or a hull, when its first shape needs it.
const Mesh& mesh_of(const world::WorldModel& model, world::MeshId id, PreparedMeshes& known) {
  auto& mesh = known.meshes[id.index()];
  if (!mesh) mesh = std::make_unique<const Mesh>(model.meshes[id.index()]);
  return *mesh;
}

const Convex& hull_of(const world::WorldModel& model, world::MeshId id, PreparedMeshes& known) {
  auto& hull = known.hulls[id.index()];
  if (!hull) hull = std::make_unique<const Convex>(make_convex(make_hull(model.meshes[id.index()].vertices)));
  return *hull;
}

// Planes and meshes are no convex shapes; they get an empty one.
Convex make_convex_of(const world::WorldModel& model, const world::Shape& shape, PreparedMeshes& known) {
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
      return hull_of(model, shape.mesh, known);
    case world::ShapeKind::kPlane:
    case world::ShapeKind::kMesh:
      break;
  }
  return {};
}

// The box around a shape, in the shape's frame.
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

PreparedShape prepare(const world::WorldModel& model, world::ShapeId id, PreparedMeshes& known) {
  const world::Shape& shape = model.shapes[id.index()];
  const world::Surface& surface = model.surfaces[shape.surface.index()];
  PreparedShape prepared;
  prepared.id = id;
  prepared.body = shape.body;
  prepared.kind = shape.kind;
  const world::Body& body = model.bodies[shape.body.index()];
  prepared.fixed = body.fixed;
  prepared.unmoved = body.fixed || body.kinematic;
  prepared.X_BS = shape.X_BS;
  prepared.friction = surface.friction;
  prepared.restitution = surface.restitution;
  prepared.rolling_friction = surface.rolling_friction;
  prepared.torsional_friction = surface.torsional_friction;
  if (shape.kind == world::ShapeKind::kMesh) {
    prepared.mesh = &mesh_of(model, shape.mesh, known);
    prepared.box_S = box_of(*prepared.mesh);
  } else if (shape.kind != world::ShapeKind::kPlane) {
    prepared.convex = make_convex_of(model, shape, known);
    prepared.gjk = std::make_unique<GjkShape>(prepared.convex);
    prepared.box_S = box_of(prepared.convex);
  }
  return prepared;
}

}  // namespace

Eigen::AlignedBox3d box_around(const Eigen::AlignedBox3d& box, const Eigen::Matrix3d& R,
                               const Eigen::Vector3d& p) {
  // Each half length is the sum of the rotated box's shares along that axis.
  const Eigen::Vector3d center = R * box.center() + p;
  const Eigen::Vector3d half = R.cwiseAbs() * (0.5 * box.sizes());
  return {center - half, center + half};
}

std::vector<PreparedShape> prepare_shapes(const world::WorldModel& model, PreparedMeshes& meshes) {
  meshes.meshes.resize(model.meshes.size());
  meshes.hulls.resize(model.meshes.size());
  std::vector<PreparedShape> shapes;
  for (std::size_t i = 0; i < model.shapes.size(); ++i) {
    if (model.shapes[i].collides) shapes.push_back(prepare(model, {static_cast<std::int32_t>(i)}, meshes));
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
