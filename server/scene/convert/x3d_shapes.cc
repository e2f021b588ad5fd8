#include "server/scene/convert/x3d_shapes.h"

#include <algorithm>
#include <filesystem>

#include "server/scene/convert/x3d_scene.h"
#include "server/scene/convert/x3d_text.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;
using world::Pose;
using world::ShapeKind;

constexpr std::size_t kMaxVertices = 3 * world::kMaxTriangles;
constexpr double kSame = 1e-6;  // m, rad: metadata agrees with the fields beside it up to here
constexpr double kLeastScale = 1e-9;

bool is_uniform(const Eigen::Matrix3d& stretch) {
  return stretch == stretch(0, 0) * Eigen::Matrix3d::Identity();
}

}  // namespace

const X3dNode* x3d_child(const X3dNode& node, const std::string& field) {
  for (const auto& [name, child] : node.children)
    if (name == field) return &child;
  return nullptr;
}

Pose x3d_exact_pose(const std::optional<Node>& metadata, const Pose& fields) {
  if (!metadata) return fields;
  const Pose exact = read_pose_or_identity(*metadata, "pose");
  const bool same = (exact.p - fields.p).norm() < kSame && exact.q.angularDistance(fields.q) < kSame;
  return same ? exact : fields;
}

X3dShapes::X3dShapes(Draft& draft, const X3dNode& root, const std::string& file)
    : draft_(draft), file_(file) {
  index(root);
  if (scripts_.empty()) return;
  const std::string rest =
      scripts_.size() == 1 ? "" : ", nor are " + std::to_string(scripts_.size() - 1) + " more";
  lose(*scripts_.front(), "a Script is not read" + rest + ": what it would change stays as it is written");
}

void X3dShapes::index(const X3dNode& node) {
  if (!node.def.empty()) defs_[node.def] = &node;
  if (node.type == "Script" && node.use.empty()) scripts_.push_back(&node);
  for (const auto& [field, child] : node.children) index(child);
}

config::Place X3dShapes::place_of(const X3dNode& node) const {
  return {file_of(node, file_), node.line, title_of(node)};
}

void X3dShapes::fail(const X3dNode& node, const std::string& message) const {
  fail_at(node, file_, message);
}

void X3dShapes::lose(const X3dNode& node, const std::string& sentence) const {
  const std::string in = node.file ? std::filesystem::path(*node.file).filename().string() + ", " : "";
  draft_.scene.losses.push_back(in + "line " + std::to_string(node.line) + ": " + sentence);
  draft_.scene.warnings.push_back({file_of(node, file_), {sentence, node.line}});
}

const X3dNode& X3dShapes::resolved(const X3dNode& node) const {
  if (node.use.empty()) return node;
  const auto found = defs_.find(node.use);
  if (found == defs_.end()) fail(node, unknown_use(node.use, defs_));
  return *found->second;
}

std::optional<Node> X3dShapes::metadata(const X3dNode& node) const {
  const X3dNode* child = x3d_child(node, "metadata");
  if (!child || child->type != "MetadataString") return {};
  const auto name = child->values.find("name"), value = child->values.find("value");
  if (name == child->values.end() || name->second != kMetadataName || value == child->values.end()) return {};
  const auto texts = texts_of(value->second);
  if (texts.size() != 1) fail(*child, "metadata of Visum must be one text");
  return config::load_text(texts.front(),
                           file_of(*child, file_) + ":" + std::to_string(child->line) + " (metadata)",
                           std::filesystem::path(file_).parent_path());
}

std::string X3dShapes::name_of(const X3dNode& node, const std::optional<Node>& metadata, const char* what,
                               std::size_t number) const {
  if (metadata && metadata->find("name")) return read_name(metadata->get("name"));
  const std::string name = flat_name(node.def);
  return name_fault(name).empty() ? name : what + std::to_string(number);
}

Eigen::Vector3d X3dShapes::vector(const X3dNode& node, const std::string& field,
                                  const Eigen::Vector3d& otherwise) const {
  const auto xyz = numbers_of(node, field, 3, {otherwise[0], otherwise[1], otherwise[2]}, file_);
  return {xyz[0], xyz[1], xyz[2]};
}

Eigen::Quaterniond X3dShapes::rotation(const X3dNode& node, const std::string& field) const {
  return quaternion_of_rotation(numbers_of(node, field, 4, {0, 0, 1, 0}, file_).data());
}

// The standard's P' = T * C * R * SR * S * -SR * -C * P.
X3dFrame X3dShapes::inside(const X3dNode& node, const X3dFrame& outer) const {
  const Eigen::Vector3d center = vector(node, "center", Eigen::Vector3d::Zero());
  const Eigen::Vector3d factors = vector(node, "scale", Eigen::Vector3d::Ones());
  const Eigen::Quaterniond q = rotation(node, "rotation");
  const Eigen::Vector3d translation = vector(node, "translation", Eigen::Vector3d::Zero());
  Eigen::Matrix3d scale = factors.asDiagonal();
  if (factors[0] != factors[1] || factors[1] != factors[2]) {
    const Eigen::Matrix3d turn = rotation(node, "scaleOrientation").toRotationMatrix();
    scale = turn * scale * turn.transpose();
  }
  if (!(factors.cwiseAbs().minCoeff() > kLeastScale)) fail(node, "scale must not be 0 along any axis");
  X3dFrame inner;
  inner.X.p = outer * Eigen::Vector3d(translation + center - q * (scale * center));
  // As long as all axes are scaled alike, turns stay turns. Below other scales they are part of the stretch.
  if (is_uniform(outer.stretch)) {
    inner.X.q = (outer.X.q * q).normalized();
    inner.stretch = outer.stretch * scale;
  } else {
    inner.X.q = outer.X.q;
    inner.stretch = outer.stretch * q.toRotationMatrix() * scale;
  }
  return inner;
}

std::vector<const X3dNode*> X3dShapes::shown(const X3dNode& node) const {
  std::vector<const X3dNode*> children;
  for (const auto& [field, child] : node.children)
    if (field == "children" || field == "level" || field == "choice") children.push_back(&child);
  if (node.type == "LOD" && children.size() > 1) return {children.front()};
  if (node.type != "Switch") return children;
  const double chosen = numbers_of(node, "whichChoice", 1, {-1.0}, file_)[0];
  if (!(chosen >= 0.0 && chosen < static_cast<double>(children.size()))) return {};
  return {children[static_cast<std::size_t>(chosen)]};
}

std::optional<world::Shape> X3dShapes::shape_of(const X3dNode& node, const X3dFrame& frame,
                                                std::size_t number, const std::optional<Node>& known) {
  if (node.type != "Shape") fail(node, "is not a Shape");
  const X3dNode* geometry = x3d_child(node, "geometry");
  if (!geometry) return {};
  const std::optional<X3dForm>& form = form_of(resolved(*geometry), frame.stretch);
  if (!form) {
    lose(*geometry, resolved(*geometry).type +
                        (is_x3d_mesh(resolved(*geometry).type) ? " has no faces" : " is not read"));
    return {};
  }
  world::Shape shape;
  shape.kind = form->kind;
  shape.size = form->size;
  if (known && known->boolean_or("convex", false) && shape.kind == ShapeKind::kMesh)
    shape.kind = ShapeKind::kConvex;
  shape.X_BS = x3d_exact_pose(known, frame.X * Pose{Eigen::Vector3d::Zero(), form->q_NS});
  shape.name = name_of(node, known, "shape_", number);
  shape.surface = {0};
  if (known && known->find("surface")) shape.surface = draft_.surface(known->get("surface"));
  read_color(node, shape);
  if (!form->mesh.triangles.empty())
    shape.mesh =
        draft_.converted_mesh(form->mesh.name, form->mesh, Eigen::Vector3d::Ones(), place_of(*geometry));
  return shape;
}

void X3dShapes::add(const X3dNode& node, world::BodyId body, const X3dFrame& frame, bool collides,
                    const std::optional<Node>& known) {
  std::optional<world::Shape> shape = shape_of(node, frame, draft_.scene.world.shapes.size(), known);
  if (!shape) return;
  shape->body = body;
  shape->collides = collides;
  draft_.add_shape(*shape, place_of(*x3d_child(node, "geometry")));
}

// Converts geometry once for each node and scale, however often it is used.
const std::optional<X3dForm>& X3dShapes::form_of(const X3dNode& node, const Eigen::Matrix3d& stretch) {
  std::array<double, 9> key{};
  std::copy_n(stretch.data(), 9, key.begin());
  const auto [entry, is_new] = forms_.try_emplace({&node, key});
  if (!is_new) return entry->second;
  entry->second = read_x3d_geometry(node, stretch, file_,
                                    [&](const X3dNode& use) -> const X3dNode& { return resolved(use); });
  if (entry->second) entry->second->mesh.name = "mesh_" + std::to_string(forms_.size());
  vertices_ += entry->second ? entry->second->mesh.vertices.size() : 0;
  if (vertices_ > kMaxVertices)
    fail(node, "all meshes have more than " + std::to_string(kMaxVertices) + " points");
  return entry->second;
}

void X3dShapes::read_color(const X3dNode& node, world::Shape& shape) const {
  const X3dNode* appearance = x3d_child(node, "appearance");
  if (!appearance) return;
  const X3dNode* material = x3d_child(resolved(*appearance), "material");
  if (!material) return;
  const auto rgb = numbers_of(resolved(*material), "diffuseColor", 3, {0.8, 0.8, 0.8}, file_);
  const double transparency = numbers_of(resolved(*material), "transparency", 1, {0.0}, file_)[0];
  for (std::size_t i = 0; i < 3; ++i) shape.color[i] = std::clamp(rgb[i], 0.0, 1.0);
  shape.color[3] = std::clamp(1.0 - transparency, 0.0, 1.0);
}

}  // namespace visum::scene
