#include "server/gateway/world_view.h"

#include <span>
#include <string>

#include "hwparts/sensors/camera.h"
#include "hwparts/sensors/range_finder.h"
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

// How many numbers of Shape::size this kind of shape uses.
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

std::vector<double> numbers(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

std::vector<double> numbers(const world::Pose& pose) {
  const auto& [p, q] = pose;
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

protocol::ShapeDescription describe(const world::Shape& shape, const world::WorldModel& model) {
  protocol::ShapeDescription description;
  description.kind = kind_name(shape.kind);
  description.size.assign(shape.size.begin(),
                          shape.size.begin() + static_cast<std::ptrdiff_t>(sizes_of(shape.kind)));
  description.pose = numbers(shape.X_BS);
  description.color.assign(shape.color.begin(), shape.color.end());
  if (shape.mesh.valid()) description.mesh = static_cast<std::uint32_t>(shape.mesh.value);
  description.surface = model.surfaces[shape.surface.index()].name;
  description.collides = shape.collides;
  description.material = static_cast<std::uint32_t>(shape.material + 1);
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
  description.pose = numbers(joint.X_PJ);
  description.axis = numbers(joint.axis_J);
  return description;
}

const char* kind_name(scene::LightKind kind) {
  switch (kind) {
    case scene::LightKind::kAmbient:
      return "ambient";
    case scene::LightKind::kDirectional:
      return "directional";
    case scene::LightKind::kPoint:
      return "point";
    case scene::LightKind::kSpot:
      return "spot";
  }
  return "";
}

protocol::SensorDescription describe(const scene::SensorPlan& plan, const scene::Scene& scene) {
  protocol::SensorDescription description;
  description.part = plan.name;
  description.kind = plan.kind;
  if (plan.body.valid()) description.body = scene.world.bodies[plan.body.index()].name;
  description.pose = numbers(plan.X_BS);
  if (plan.kind == "distance" || plan.kind == "scanner") {
    const auto reach = sensors::read_reach(plan.config);
    description.range = {reach.lowest_m, reach.highest_m};
  }
  if (plan.kind == "scanner") {
    const auto beams = sensors::read_beams(plan.config);
    description.angle = {beams.front(), beams.back()};
  }
  if (plan.kind == "camera") {
    const auto camera = sensors::read_camera(plan.config, plan.name, scene.seed);
    description.range = {0.0, camera.farthest_m};
    description.fov = camera.lens.fov_rad;
    description.aspect = static_cast<double>(camera.lens.width) / camera.lens.height;
  }
  return description;
}

void describe_looks(const scene::Scene& scene, WorldView& view) {
  auto& world = view.description;
  for (const auto& m : scene.looks.materials)
    world.materials.push_back({m.name,
                               m.roughness,
                               m.metalness,
                               static_cast<std::uint32_t>(m.texture + 1),
                               {m.texture_size_m.begin(), m.texture_size_m.end()}});
  for (const auto& light : scene.looks.lights)
    world.lights.push_back({light.name,
                            kind_name(light.kind),
                            {light.color.begin(), light.color.begin() + 3},
                            light.intensity,
                            numbers(light.position),
                            numbers(light.direction),
                            light.angle_rad,
                            light.shadows});
  for (const auto& v : scene.looks.viewpoints)
    world.viewpoints.push_back({v.name, numbers(v.position), numbers(v.target), v.fov_rad});
  for (const auto& panel : scene.looks.panels) world.panels.push_back({panel.name, panel.text});
  world.losses = scene.losses;
  for (const auto& texture : scene.looks.textures) {
    const auto bytes = std::as_bytes(std::span(texture.bytes));
    view.textures.push_back({texture.content_type, {bytes.begin(), bytes.end()}});
  }
}

// A kinematic body has none.
std::string engine_of(const world::WorldModel& model, const world::Body& body) {
  return body.kinematic ? "" : model.engines[static_cast<std::size_t>(body.engine)].name;
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
                            engine_of(model, body),
                            numbers(body.p_BC),
                            body.kinematic});
  for (const auto& shape : model.shapes)
    world.bodies[shape.body.index()].shapes.push_back(describe(shape, model));
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    world.joints.push_back(describe(model.joints[i], world::JointId{static_cast<std::int32_t>(i)}, scene));
  for (const auto& sensor : scene.sensors) world.sensors.push_back(describe(sensor, scene));
  describe_looks(scene, view);
  for (const auto& mesh : model.meshes) view.meshes.push_back(describe(mesh));
  for (const auto& spawned : scene.spawned) {
    view.spawned.push_back({spawned.name, spawned.bodies, spawned.parts});
    auto& parts = view.spawned.back().parts;
    parts.insert(parts.end(), spawned.sensors.begin(), spawned.sensors.end());
  }
  return view;
}

}  // namespace visum::gateway
