#include "server/scene/draft.h"

#include <algorithm>

#include "protocol/config/number_text.h"
#include "protocol/config/unknown_name.h"
#include "protocol/plugin/library.h"
#include "server/scene/hulls.h"
#include "server/scene/mesh_readers.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

void refuse_fault(const std::string& fault, const config::Place& place) {
  if (!fault.empty()) throw config::ConfigError(place, fault);
}

[[noreturn]] void fail_unknown(const config::Node& node, const std::string& what,
                               const std::vector<std::string>& known) {
  node.fail(config::unknown_name(what, node.text(), known));
}

bool mirrors(const Eigen::Vector3d& scale) {
  return scale[0] * scale[1] * scale[2] < 0;
}

void apply_scale(world::TriangleMesh& mesh, const Eigen::Vector3d& scale) {
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex = vertex.cwiseProduct(scale);
  // A mirrored solid is turned inside out: its faces must be walked the other way round.
  if (mirrors(scale))
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

}  // namespace

Draft::Draft(Scene& of)
    : scene(of), old_bodies_(of.world.bodies.size()), old_joints_(of.world.joints.size()) {
  const config::Place earlier{scene.file.string(), 0, ""};
  for (std::size_t i = 0; i < scene.world.bodies.size(); ++i) {
    const std::string& name = scene.world.bodies[i].name;
    names_.emplace("body '" + name + "'", earlier);
    add_link_name(name, {{static_cast<std::int32_t>(i)}, {}});
  }
  for (const world::TriangleMesh& mesh : scene.world.meshes) triangles_ += mesh.triangles.size();
  const auto take = [&](const char* what, const std::string& name) {
    names_.emplace(what + (" '" + name + "'"), earlier);
  };
  for (const world::Joint& joint : scene.world.joints) take("joint", joint.name);
  for (const ModelPlan& model : scene.models) take("model", model.name);
  for (const PartPlan& part : scene.parts) take("part", part.context.name);
  for (const SensorPlan& sensor : scene.sensors) take("part", sensor.name);
  for (const AgentPlan& agent : scene.agents) take("part", agent.name);
  for (const world::Surface& surface : scene.world.surfaces) take("surface", surface.name);
  for (const Material& material : scene.looks.materials) take("material", material.name);
}

void Draft::claim(const std::string& what, const std::string& name, const config::Place& place) {
  const auto [entry, is_new] = names_.try_emplace(what + " '" + name + "'", place);
  if (is_new) return;
  const config::Place& first = entry->second;
  const std::string line = first.line > 0 ? ":" + std::to_string(first.line) : "";
  throw config::ConfigError(place, "there is already a " + entry->first + " (" + first.file + line + ")");
}

world::SurfaceId Draft::surface(const config::Node& node) const {
  const std::string name = node.text();
  std::vector<std::string> known;
  for (std::size_t i = 0; i < scene.world.surfaces.size(); ++i) {
    if (scene.world.surfaces[i].name == name) return {static_cast<std::int32_t>(i)};
    known.push_back(scene.world.surfaces[i].name);
  }
  fail_unknown(node, "surface", known);
}

world::SurfaceId Draft::surface_like(const world::Surface& values, const config::Place& place) {
  std::string name = "friction_" + config::number_text(values.friction);
  if (values.restitution > 0.0) name += "_restitution_" + config::number_text(values.restitution);
  if (values.rolling_friction > 0.0) name += "_rolling_" + config::number_text(values.rolling_friction);
  if (values.torsional_friction > 0.0) name += "_torsional_" + config::number_text(values.torsional_friction);
  const auto same = [&](const world::Surface& other) {
    return std::tie(other.friction, other.restitution, other.rolling_friction, other.torsional_friction) ==
           std::tie(values.friction, values.restitution, values.rolling_friction, values.torsional_friction);
  };
  auto& surfaces = scene.world.surfaces;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    if (same(surfaces[i])) return {static_cast<std::int32_t>(i)};
  if (surfaces.size() == kMaxSurfaces)
    throw config::ConfigError(place, "there are more than " + std::to_string(kMaxSurfaces) + " surfaces");
  surfaces.push_back(values);
  surfaces.back().name = name;
  return {static_cast<std::int32_t>(surfaces.size() - 1)};
}

bool Draft::is_impulse(std::int32_t engine) const {
  const std::string& given = scene.world.engines[static_cast<std::size_t>(engine)].name;
  const std::string& name = engine_option.empty() ? given : engine_option;
  return name == "impulse" && !plugin::find_engine(scene.plugins, name);
}

std::int32_t Draft::material(const config::Node& node) const {
  const std::string name = node.text();
  std::vector<std::string> known;
  for (std::size_t i = 0; i < scene.looks.materials.size(); ++i) {
    if (scene.looks.materials[i].name == name) return static_cast<std::int32_t>(i);
    known.push_back(scene.looks.materials[i].name);
  }
  fail_unknown(node, "material", known);
}

std::int32_t Draft::engine(const config::Node& node) const {
  const auto found = std::find(scene.engine_names.begin(), scene.engine_names.end(), node.text());
  if (found == scene.engine_names.end()) fail_unknown(node, "engine", scene.engine_names);
  return static_cast<std::int32_t>(found - scene.engine_names.begin());
}

world::Pose Draft::frame(const config::Node& node) const {
  const auto found = frames.find(node.text());
  if (found != frames.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, pose] : frames) known.push_back(name);
  fail_unknown(node, "frame", known);
}

LinkFrame Draft::link(const config::Node& node, const std::string& prefix) const {
  const auto found = links_.find(prefix + node.text());
  if (found != links_.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, frame] : links_)
    if (name.compare(0, prefix.size(), prefix) == 0) known.push_back(name.substr(prefix.size()));
  fail_unknown(node, "body", known);
}

world::BodyId Draft::body(const std::string& name) const {
  const auto found = links_.find(name);
  return found == links_.end() ? world::BodyId{} : found->second.body;
}

world::BodyId Draft::add_body(const world::Body& body, const config::Place& place) {
  claim("body", body.name, place);
  if (scene.world.bodies.size() == world::kMaxBodies)
    throw config::ConfigError(place, "there are more than " + std::to_string(world::kMaxBodies) + " bodies");
  refuse_fault(world::fault_of(scene.world, body), place);
  scene.world.bodies.push_back(body);
  const world::BodyId id{static_cast<std::int32_t>(scene.world.bodies.size() - 1)};
  add_link_name(body.name, {id, {}});
  return id;
}

void Draft::add_shape(const world::Shape& shape, const config::Place& place) {
  refuse_fault(world::fault_of(scene.world, shape), place);
  scene.world.shapes.push_back(shape);
}

void Draft::add_joint(const world::Joint& joint, const config::Place& place) {
  claim("joint", joint.name, place);
  refuse_fault(world::fault_of(scene.world, joint), place);
  scene.world.joints.push_back(joint);
  if (joint.parent.valid() && world::info(joint.kind).holds_anything)
    forbid_collision(joint.parent, joint.child);
}

void Draft::forbid_collision(world::BodyId a, world::BodyId b) {
  if (a != b) scene.world.no_collision.emplace_back(std::min(a, b), std::max(a, b));
}

world::MeshId Draft::mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                          const config::Place& wanted_by, const world::TriangleMesh* known) {
  const auto [entry, is_new] = meshes_.try_emplace({file.string(), scale[0], scale[1], scale[2]});
  if (is_new) entry->second = add_mesh(known ? *known : read_mesh(file, wanted_by), scale, wanted_by);
  return entry->second;
}

world::MeshId Draft::converted_mesh(const std::string& name, const world::TriangleMesh& mesh,
                                    const Eigen::Vector3d& scale, const config::Place& wanted_by) {
  const auto [entry, is_new] = meshes_.try_emplace({name, scale[0], scale[1], scale[2]});
  if (is_new) entry->second = add_mesh(mesh, scale, wanted_by);
  return entry->second;
}

world::MeshId Draft::hull_of(world::MeshId id, const config::Place& wanted_by) {
  const world::TriangleMesh& mesh = scene.world.meshes[id.index()];
  if (is_flat(mesh)) return {};
  if (mesh.vertices.size() <= kMaxHullVertices) return id;
  const auto [entry, is_new] = meshes_.try_emplace({"hull of mesh " + std::to_string(id.index()), 1, 1, 1});
  if (is_new) entry->second = add_mesh(thin_hull(mesh), Eigen::Vector3d::Ones(), wanted_by);
  return entry->second;
}

world::MeshId Draft::add_mesh(world::TriangleMesh mesh, const Eigen::Vector3d& scale,
                              const config::Place& wanted_by) {
  apply_scale(mesh, scale);
  triangles_ += mesh.triangles.size();
  if (triangles_ > world::kMaxTriangles)
    throw config::ConfigError(wanted_by, "the meshes of the scene have more than " +
                                             std::to_string(world::kMaxTriangles) + " triangles");
  scene.world.meshes.push_back(std::move(mesh));
  return {static_cast<std::int32_t>(scene.world.meshes.size() - 1)};
}

}  // namespace visum::scene
