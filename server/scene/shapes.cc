#include "server/scene/shapes.h"

#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;
using world::ShapeKind;

Eigen::Vector3d read_scale(const Node& entry) {
  const auto node = entry.find("scale");
  if (!node) return Eigen::Vector3d::Ones();
  const bool uniform = node->kind() == Node::Kind::kScalar;
  const Eigen::Vector3d scale =
      uniform ? Eigen::Vector3d::Constant(node->number(kPlaceable)) : read_vector(*node);
  if ((scale.array() == 0.0).any()) node->fail("must not be zero");
  return scale;
}

void read_box(const Node& node, world::Shape& shape) {
  const Eigen::Vector3d lengths = read_vector(node, kSize);
  shape.size = {lengths[0], lengths[1], lengths[2]};
}

// Reads `sphere: 0.1` or `sphere: {radius: 0.1}`.
void read_sphere(const Node& node, world::Shape& shape) {
  if (node.kind() == Node::Kind::kMap) node.allow_only({"radius"});
  shape.size[0] = (node.kind() == Node::Kind::kMap ? node.get("radius") : node).number(kSize);
}

void read_round(const Node& node, world::Shape& shape) {
  node.allow_only({"radius", "length"});
  shape.size[0] = node.get("radius").number(kSize);
  shape.size[1] = node.get("length").number(kSize);
}

void read_plane(const Node& node) {
  if (!node.boolean()) node.fail("must be true, or left out");
}

void read_geometry(Draft& draft, const Node& entry, const Node& node, world::Shape& shape) {
  const bool is_mesh = shape.kind == ShapeKind::kConvex || shape.kind == ShapeKind::kMesh;
  if (!is_mesh && entry.find("scale")) entry.get("scale").fail("only 'convex' and 'mesh' are scaled");
  switch (shape.kind) {
    case ShapeKind::kBox:
      return read_box(node, shape);
    case ShapeKind::kSphere:
      return read_sphere(node, shape);
    case ShapeKind::kCylinder:
    case ShapeKind::kCapsule:
      return read_round(node, shape);
    case ShapeKind::kPlane:
      return read_plane(node);
    case ShapeKind::kConvex:
    case ShapeKind::kMesh:
      shape.mesh = draft.mesh(read_path(node), read_scale(entry), node.place());
  }
}

struct KindWord {
  const char* word;
  ShapeKind kind;
};
constexpr KindWord kKinds[] = {{"box", ShapeKind::kBox},           {"sphere", ShapeKind::kSphere},
                               {"cylinder", ShapeKind::kCylinder}, {"capsule", ShapeKind::kCapsule},
                               {"plane", ShapeKind::kPlane},       {"convex", ShapeKind::kConvex},
                               {"mesh", ShapeKind::kMesh}};
constexpr const char* kKindList = "box, sphere, cylinder, capsule, plane, convex or mesh";

KindWord find_kind(const Node& entry) {
  const KindWord* found = nullptr;
  for (const KindWord& candidate : kKinds) {
    if (!entry.find(candidate.word)) continue;
    if (found)
      entry.fail(std::string("is both '") + found->word + "' and '" + candidate.word + "', needs one");
    found = &candidate;
  }
  if (!found) entry.fail(std::string("needs one of ") + kKindList);
  return *found;
}

}  // namespace

ShapeDefaults read_defaults(const Draft& draft, const Node& node, const ShapeDefaults& otherwise) {
  ShapeDefaults own = otherwise;
  if (const auto surface = node.find("surface")) own.surface = draft.surface(*surface);
  if (const auto material = node.find("material")) {
    own.material = draft.material(*material);
    own.color = draft.scene.looks.materials[static_cast<std::size_t>(own.material)].color;
  }
  if (const auto color = node.find("color")) own.color = read_color(*color);
  return own;
}

world::Shape read_shape(Draft& draft, const Node& node, std::size_t index, const ShapeDefaults& defaults) {
  node.allow_only({"box", "sphere", "cylinder", "capsule", "plane", "convex", "mesh", "scale", "name", "pose",
                   "surface", "color", "material", "collides"});
  const KindWord kind = find_kind(node);
  world::Shape shape;
  shape.kind = kind.kind;
  const auto name = node.find("name");
  shape.name = name ? read_name(*name) : kind.word + ("_" + std::to_string(index));
  shape.X_BS = read_pose_or_identity(node, "pose");
  const ShapeDefaults own = read_defaults(draft, node, defaults);
  shape.surface = own.surface;
  shape.color = own.color;
  shape.material = own.material;
  shape.collides = node.boolean_or("collides", true);
  read_geometry(draft, node, node.get(kind.word), shape);
  const auto& materials = draft.scene.looks.materials;
  if (shape.mesh.valid() && shape.material >= 0 &&
      materials[static_cast<std::size_t>(shape.material)].texture >= 0)
    node.fail("a mesh has no coordinates for a texture: give it a material without one");
  return shape;
}

MassProperties solid_in_body(const Draft& draft, const world::Shape& shape, const Node& node) {
  const world::TriangleMesh* mesh = nullptr;
  if (shape.mesh.valid()) mesh = &draft.scene.world.meshes[shape.mesh.index()];
  if (mesh) {
    const std::string fault = solid_fault(*mesh);
    if (!fault.empty())
      node.fail("mesh '" + mesh->name + "' " + fault +
                ", so it has no inertia: give the body 'mass' and 'inertia'");
  }
  return moved(solid_of(shape, mesh), shape.X_BS);
}

}  // namespace visum::scene
