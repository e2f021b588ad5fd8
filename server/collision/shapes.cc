#include "server/collision/shapes.h"

#include <set>
#include <stdexcept>
#include <vector>

#include "server/world/on_processors.h"
#include "server/world/same_bits.h"

namespace visum::collision {
namespace {

constexpr std::size_t kManyMeshes = 4;
constexpr std::size_t kMostThreads = 4;

std::shared_ptr<const Solid> make_solid(const world::WorldModel& model, const world::Shape& shape,
                                        PreparedMeshes& meshes) {
  switch (shape.kind) {
    case world::ShapeKind::kBox:
      return std::make_shared<const Solid>(
          make_convex(make_box({shape.size[0], shape.size[1], shape.size[2]})));
    case world::ShapeKind::kSphere:
      return std::make_shared<const Solid>(make_round(shape.size[0], 0.0));
    case world::ShapeKind::kCylinder:
      return std::make_shared<const Solid>(make_cylinder(shape.size[0], shape.size[1]));
    case world::ShapeKind::kCapsule:
      return std::make_shared<const Solid>(make_round(shape.size[0], shape.size[1]));
    case world::ShapeKind::kConvex:
      return meshes.hull(model.meshes[shape.mesh.index()]);
    case world::ShapeKind::kPlane:
    case world::ShapeKind::kMesh:
      break;
  }
  return nullptr;
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

PreparedShape prepare(const world::WorldModel& model, world::ShapeId id, PreparedMeshes& meshes) {
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
    prepared.mesh = meshes.mesh(model.meshes[shape.mesh.index()]);
    prepared.box_S = box_of(*prepared.mesh);
  } else if (shape.kind != world::ShapeKind::kPlane) {
    prepared.solid = make_solid(model, shape, meshes);
    prepared.box_S = box_of(prepared.solid->convex);
  }
  return prepared;
}

// The meshes of the shapes of a kind that collide, each once.
std::vector<const world::TriangleMesh*> meshes_of(const world::WorldModel& model, world::ShapeKind kind) {
  std::set<world::MeshId> ids;
  for (const world::Shape& shape : model.shapes)
    if (shape.collides && shape.kind == kind && shape.mesh.valid()) ids.insert(shape.mesh);
  std::vector<const world::TriangleMesh*> meshes;
  for (const world::MeshId id : ids) meshes.push_back(&model.meshes[id.index()]);
  return meshes;
}

// Prepares hulls and trees on several threads, where there are many new ones. Their faults come again where
// the shape is prepared.
void prepare_meshes(const world::WorldModel& model, PreparedMeshes& meshes) {
  const auto hulls = meshes.without_hull(meshes_of(model, world::ShapeKind::kConvex));
  const auto trees = meshes.without_tree(meshes_of(model, world::ShapeKind::kMesh));
  const std::size_t count = hulls.size() + trees.size();
  if (count < kManyMeshes) return;
  world::on_processors(count, kMostThreads, [&](std::size_t i) {
    try {
      if (i < hulls.size())
        meshes.hull(*hulls[i]);
      else
        meshes.mesh(*trees[i - hulls.size()]);
    } catch (const std::exception&) {
      // It comes again.
    }
  });
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
  prepare_meshes(model, meshes);
  std::vector<PreparedShape> shapes;
  for (std::size_t i = 0; i < model.shapes.size(); ++i) {
    if (model.shapes[i].collides) shapes.push_back(prepare(model, {static_cast<std::int32_t>(i)}, meshes));
  }
  return shapes;
}

void place(PreparedShape& shape, const world::WorldModel& model, const world::WorldState& state) {
  const world::BodyState& body = state.bodies[shape.body.index()];
  if (shape.placements > 0 && world::are_same_bits(shape.p_WC, body.p_WC) &&
      world::are_same_bits(shape.q_WB, body.q_WB))
    return;
  ++shape.placements;
  shape.p_WC = body.p_WC;
  shape.q_WB = body.q_WB;
  const world::Pose X_WS = link_pose(model.bodies[shape.body.index()], body) * shape.X_BS;
  const Solid* solid = shape.solid.get();
  shape.placed = {solid ? &solid->convex : nullptr, solid ? &solid->gjk : nullptr, X_WS.q.toRotationMatrix(),
                  X_WS.p};
  shape.box_W.setEmpty();
  if (shape.placed.p.allFinite() && shape.placed.R.allFinite() && !shape.box_S.isEmpty())
    shape.box_W = box_around(shape.box_S, shape.placed.R, shape.placed.p);
}

}  // namespace visum::collision
