#include "server/gateway/world_view.h"

#include <string>

#include "server/world/joint_kinds.h"

namespace visum::gateway {
namespace {

const char* kind_name(world::ShapeKind kind) {
  switch (kind) {
    case world::ShapeKind::kBox:
      return "box";
    case world::ShapeKind::kSphere:
      return "sphere";
    case world::ShapeKind::kCylinder:
      return "cylinder";
    case world::ShapeKind::kCapsule:
      return "capsule";
    case world::ShapeKind::kPlane:
      return "plane";
    case world::ShapeKind::kConvex:
      return "convex";
    case world::ShapeKind::kMesh:
      return "mesh";
  }
  return "";
}

// How many numbers of Shape::size mean something.
std::size_t sizes_of(world::ShapeKind kind) {
  switch (kind) {
    case world::ShapeKind::kBox:
      return 3;
    case world::ShapeKind::kSphere:
      return 1;
    case world::ShapeKind::kCylinder:
    case world::ShapeKind::kCapsule:
      return 2;
    default:
      return 0;
  }
}

protocol::ShapeDescription describe(const world::Shape& shape, const world::WorldModel& model) {
  const auto& [p, q] = shape.X_BS;
  protocol::ShapeDescription description;
  description.kind = kind_name(shape.kind);
  description.size.assign(shape.size.begin(),
                          shape.size.begin() + static_cast<std::ptrdiff_t>(sizes_of(shape.kind)));
  description.pose = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
  description.color.assign(shape.color.begin(), shape.color.end());
  if (shape.mesh.valid()) description.mesh = static_cast<std::uint32_t>(shape.mesh.value);
  description.surface = model.surfaces[shape.surface.index()].name;
  description.collides = shape.collides;
  return description;
}

protocol::MeshData describe(const world::TriangleMesh& mesh) {
  protocol::MeshData data;
  for (const auto& vertex : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) data.vertices.push_back(static_cast<float>(vertex[axis]));
  for (const auto& triangle : mesh.triangles)
    data.triangles.insert(data.triangles.end(), triangle.begin(), triangle.end());
  return data;
}

std::string driving_part(const scene::Scene& scene, world::JointId joint) {
  for (const auto& part : scene.parts)
    for (const auto driven : part.joints)
      if (driven == joint) return part.context.name;
  return {};
}

protocol::JointDescription describe(const world::Joint& joint, world::JointId id, const scene::Scene& scene) {
  const auto& bodies = scene.world.bodies;
  protocol::JointDescription description;
  description.name = joint.name;
  description.type = world::info(joint.kind).name;
  if (joint.parent.valid()) description.parent = bodies[joint.parent.index()].name;
  description.child = bodies[joint.child.index()].name;
  description.lower = joint.limited ? joint.lower : 0.0;
  description.upper = joint.limited ? joint.upper : 0.0;
  description.part = driving_part(scene, id);
  return description;
}

}  // namespace

WorldView describe_world(const scene::Scene& scene, std::uint64_t revision) {
  const auto& model = scene.world;
  WorldView view;
  auto& world = view.description;
  world.scene = scene.name;
  world.tick_ns = model.tick_ns;
  world.gravity = {model.gravity.x(), model.gravity.y(), model.gravity.z()};
  world.revision = revision;
  for (const auto& body : model.bodies)
    world.bodies.push_back({body.name,
                            body.model,
                            body.fixed,
                            body.mass_kg,
                            {},
                            model.engines[static_cast<std::size_t>(body.engine)].name});
  for (const auto& shape : model.shapes)
    world.bodies[shape.body.index()].shapes.push_back(describe(shape, model));
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    world.joints.push_back(describe(model.joints[i], world::JointId{static_cast<std::int32_t>(i)}, scene));
  for (const auto& mesh : model.meshes) view.meshes.push_back(describe(mesh));
  return view;
}

}  // namespace visum::gateway
