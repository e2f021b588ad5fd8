#include "server/scene/convert/write_yaml.h"

#include <algorithm>
#include <numbers>
#include <set>

#include "server/scene/convert/pairs.h"
#include "server/scene/convert/yaml_text.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

using world::JointKind;
using world::ShapeKind;

constexpr double kNsPerMs = 1e6, kNsPerS = 1e9;

std::string engine_text(const world::EngineSetting& engine) {
  const world::EngineSetting usual;
  YamlMap map;
  map.add_text("kind", engine.name);
  if (engine.step != usual.step) map.add_text("step", engine.step);
  map.add_unless("iterations", engine.iterations, usual.iterations);
  map.add_unless("erp", engine.erp, usual.erp).add_unless("cfm", engine.cfm, usual.cfm);
  if (engine.solver != usual.solver) map.add_text("solver", engine.solver);
  map.add_unless("order", engine.order, usual.order).add_unless("d_max", engine.d_max, usual.d_max);
  map.add_unless("v_max", engine.v_max, usual.v_max).add_unless("budget", engine.budget, usual.budget);
  map.add_unless("sleep", engine.sleep_s, usual.sleep_s);
  map.add_unless("work_limit", static_cast<double>(engine.work_limit), static_cast<double>(usual.work_limit));
  if (engine.impact != usual.impact) map.add_text("impact", engine.impact);
  return map.text();
}

// Only the plug-in knows the settings of its engine, so its entry is copied.
std::string engine_text(const Scene& scene, std::size_t number) {
  const auto plugged = scene.plugged_engines.find(number);
  return plugged == scene.plugged_engines.end() ? engine_text(scene.world.engines[number])
                                                : yaml_of(plugged->second);
}

std::string surface_text(const world::Surface& surface) {
  YamlMap map;
  map.add_number("friction", surface.friction).add_number("restitution", surface.restitution);
  map.add_unless("rolling_friction", surface.rolling_friction, 0.0);
  map.add_unless("torsional_friction", surface.torsional_friction, 0.0);
  return map.text();
}

std::string engines_text(const Scene& scene) {
  YamlMap others;
  for (std::size_t i = 1; i < scene.world.engines.size(); ++i)
    others.add(scene.engine_names[i], engine_text(scene, i));
  return others.empty() ? "" : others.text();
}

// Turns one scene into a text.
class YamlWriter {
 public:
  YamlWriter(const Scene& scene, Output& output) : scene_(scene), world_(scene.world), output_(output) {}

  std::string text() {
    settings();
    list("plugins", scene_.plugins, [&](const auto& library) { return yaml_text(library.name); });
    materials();
    list("models", scene_.models, [&](const auto& model) { return model_text(model); });
    bodies();
    joints();
    no_collision();
    list("parts", scene_.parts, [&](const auto& part) { return part_text(part.context.config); });
    list("sensors", scene_.sensors, [&](const auto& sensor) { return sensor_text(sensor); });
    list("agents", scene_.agents, [&](const auto& agent) { return yaml_of(agent.config); });
    looks();
    return text_;
  }

 private:
  void line(const std::string& key, const std::string& value) { text_ += key + ": " + value + "\n"; }

  // Writes a list with one entry on a line. An entry for which `write` returns "" is left out.
  template <typename Entries, typename Write>
  void list(const char* key, const Entries& entries, const Write& write) {
    std::string lines;
    for (const auto& entry : entries)
      if (const std::string one = write(entry); !one.empty()) lines += "  - " + one + "\n";
    if (!lines.empty()) text_ += std::string(key) + ":\n" + lines;
  }

  void settings() {
    line("visum", "1");
    for (const auto& [key, value] : settings_of(scene_)) line(key, value);
  }

  void materials() {
    YamlMap map;
    for (const auto& material : scene_.looks.materials) {
      YamlMap entry;
      entry.add("color", yaml_list(material.color.data(), 4));
      entry.add_number("roughness", material.roughness).add_number("metalness", material.metalness);
      if (material.texture >= 0) {
        const auto& texture = scene_.looks.textures[static_cast<std::size_t>(material.texture)];
        entry.add_text("texture", output_.add_file(texture.name, texture.bytes));
        entry.add("texture_size", yaml_list(material.texture_size_m.data(), 2));
      }
      map.add(material.name, entry.text());
    }
    if (!map.empty()) line("materials", map.text());
  }

  // A file name of an entry, as it must stand in the file that is written.
  std::string file_of(const config::Node& node) const {
    return yaml_text(output_.path_to(node.folder() / node.text()));
  }

  // The entry as it was read, with its file and its place in the world.
  std::string model_text(const ModelPlan& model) const {
    return yaml_of(model.config,
                   {{"file", file_of(model.config.get("file"))}, {"pose", yaml_pose(model.X_WM)}});
  }

  std::string part_text(const config::Node& entry) const {
    const auto drives = entry.find("drives");
    if (!drives || drives->kind() != config::Node::Kind::kScalar) return yaml_of(entry);
    return yaml_of(entry, {{"drives", file_of(*drives)}});
  }

  // A sensor in the world may have been placed in a frame, or by an including file.
  static std::string sensor_text(const SensorPlan& sensor) {
    const std::string pose = yaml_pose(sensor.X_BS);
    const bool placed = !sensor.body.valid() && (sensor.config.find("pose") || pose != "{}");
    return placed ? yaml_of(sensor.config, {{"pose", pose}}) : yaml_of(sensor.config);
  }

  // Notes a loss of order: a file's models are read before its bodies, but includes may have mixed them.
  void tell_order() {
    bool model_comes = false;
    for (std::size_t i = world_.bodies.size(); i-- > 0;) {
      model_comes = model_comes || !world_.bodies[i].model.empty();
      if (world_.bodies[i].model.empty() && model_comes)
        return output_.lose("in one file models come before bodies, and '" + world_.bodies[i].name +
                            "' moves behind them: the world is the same, but not its state hash");
    }
  }

  void bodies() {
    tell_order();
    std::string lines;
    for (std::size_t i = 0; i < world_.bodies.size(); ++i)
      if (world_.bodies[i].model.empty()) lines += body_text({static_cast<std::int32_t>(i)});
    if (!lines.empty()) text_ += "bodies:\n" + lines;
  }

  std::string body_text(world::BodyId id) {
    const world::Body& body = world_.bodies[id.index()];
    YamlMap map;
    map.add_text("name", body.name);
    if (body.fixed) map.add("fixed", "true");
    if (body.kinematic) map.add("kinematic", "true");
    map.add_pose(body.X_WB);
    if (!body.fixed) motion(body, map);
    std::string shapes;
    for (const auto& shape : world_.shapes)
      if (shape.body == id) shapes += (shapes.empty() ? "" : ", ") + shape_text(shape);
    if (!shapes.empty()) map.add("shapes", "[" + shapes + "]");
    return "  - " + map.text() + "\n";
  }

  void motion(const world::Body& body, YamlMap& map) const {
    const auto& i = body.inertia_C;
    const double inertia[] = {i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)};
    if (!body.kinematic)
      map.add_number("mass", body.mass_kg)
          .add("inertia", yaml_list(inertia, 6))
          .add("com", yaml_list(body.p_BC));
    YamlMap velocity;
    if (body.v_WB != Eigen::Vector3d::Zero()) velocity.add("linear", yaml_list(body.v_WB));
    if (body.w_WB != Eigen::Vector3d::Zero()) velocity.add("angular", yaml_list(body.w_WB));
    if (!velocity.empty()) map.add("velocity", velocity.text());
    if (body.engine > 0) map.add_text("engine", scene_.engine_names[static_cast<std::size_t>(body.engine)]);
  }

  std::string shape_text(const world::Shape& shape) {
    YamlMap map, round;
    switch (shape.kind) {
      case ShapeKind::kBox:
        map.add("box", yaml_list(shape.size.data(), 3));
        break;
      case ShapeKind::kSphere:
        map.add_number("sphere", shape.size[0]);
        break;
      case ShapeKind::kCylinder:
      case ShapeKind::kCapsule:
        round.add_number("radius", shape.size[0]).add_number("length", shape.size[1]);
        map.add(shape.kind == ShapeKind::kCylinder ? "cylinder" : "capsule", round.text());
        break;
      case ShapeKind::kPlane:
        map.add("plane", "true");
        break;
      case ShapeKind::kConvex:
      case ShapeKind::kMesh:
        map.add_text(shape.kind == ShapeKind::kConvex ? "convex" : "mesh",
                     output_.add_mesh(world_.meshes[shape.mesh.index()]));
    }
    map.add_text("name", shape.name).add_pose(shape.X_BS);
    if (shape.surface.index() != 0) map.add_text("surface", world_.surfaces[shape.surface.index()].name);
    if (shape.material >= 0)
      map.add_text("material", scene_.looks.materials[static_cast<std::size_t>(shape.material)].name);
    map.add("color", yaml_list(shape.color.data(), 4));
    if (!shape.collides) map.add("collides", "false");
    return map.text();
  }

  // Joints of models come with their models.
  bool is_of_model(const world::Joint& joint) const {
    const std::string& model = world_.bodies[joint.child.index()].model;
    return !model.empty() && joint.name.starts_with(model + "/");
  }

  void joints() {
    std::string lines;
    for (const auto& joint : world_.joints)
      if (!is_of_model(joint)) lines += "  - " + joint_text(joint) + "\n";
    if (!lines.empty()) text_ += "joints:\n" + lines;
  }

  std::string joint_text(const world::Joint& joint) const {
    const auto& kind = world::info(joint.kind);
    YamlMap map;
    map.add_text("name", joint.name).add_text("type", kind.name);
    if (joint.parent.valid()) map.add_text("parent", world_.bodies[joint.parent.index()].name);
    map.add_text("child", world_.bodies[joint.child.index()].name).add_pose(joint.X_PJ);
    const bool has_axis = kind.drivable || joint.kind == JointKind::kUniversal ||
                          joint.kind == JointKind::kCylindrical || joint.kind == JointKind::kPointOnPlane ||
                          joint.kind == JointKind::kPointOnLine || joint.kind == JointKind::kTorsionSpring;
    if (has_axis) map.add("axis", yaml_list(joint.axis_J));
    if (joint.kind == JointKind::kUniversal) map.add("axis2", yaml_list(joint.axis2_J));
    if (joint.kind == JointKind::kScrew) map.add_number("pitch", joint.pitch_m);
    if (joint.kind == JointKind::kPointOnCurve) curve(joint.curve_J, map);
    if (kind.drivable) freedom(joint, map);
    if (!kind.holds_anything) spring(joint, map);
    return map.text();
  }

  static void curve(const world::Curve& curve, YamlMap& map) {
    // A closed curve has its first point once more at its end.
    const std::size_t count = curve.points().size() - (curve.closed() ? 1 : 0);
    std::string points;
    for (std::size_t i = 0; i < count; ++i) points += (i == 0 ? "" : ", ") + yaml_list(curve.points()[i]);
    map.add("points", "[" + points + "]");
    if (curve.closed()) map.add("closed", "true");
  }

  // The keys of joints that can be driven.
  static void freedom(const world::Joint& joint, YamlMap& map) {
    if (joint.limited) {
      const double limits[] = {joint.lower, joint.upper};
      map.add("limits", yaml_list(limits, 2));
    }
    map.add_unless("friction", joint.friction, 0.0).add_unless("damping", joint.damping, 0.0);
    map.add_unless("stop_restitution", joint.stop_restitution, 0.0);
    map.add_number("position", joint.initial_position);
  }

  static void spring(const world::Joint& joint, YamlMap& map) {
    if (joint.kind == JointKind::kSpring) map.add("child_point", yaml_list(joint.X_CJ.p));
    map.add_number("stiffness", joint.stiffness).add_number("rest", joint.rest);
    map.add_unless("damping", joint.damping, 0.0);
  }

  // The pairs that neither joints nor the entries of models say already.
  void no_collision() {
    std::set<std::string> limp;  // models whose entries say that none of their links collide
    for (const ModelPlan& model : scene_.models)
      if (!model.config.boolean_or("self_collision", true)) limp.insert(model.name);
    const auto joined = [](const world::Joint& joint) { return world::info(joint.kind).holds_anything; };
    list("no_collision", pairs_beside_joints(world_, joined), [&](const auto& pair) {
      const auto& a = world_.bodies[pair.first.index()];
      const auto& b = world_.bodies[pair.second.index()];
      const bool known = a.model == b.model && limp.contains(a.model);
      return known ? std::string() : "[" + yaml_text(a.name) + ", " + yaml_text(b.name) + "]";
    });
  }

  void looks() {
    list("lights", scene_.looks.lights, [](const Light& light) { return light_text(light); });
    list("viewpoints", scene_.looks.viewpoints, [](const Viewpoint& viewpoint) {
      YamlMap map;
      map.add_text("name", viewpoint.name).add("position", yaml_list(viewpoint.position));
      map.add("target", yaml_list(viewpoint.target));
      return map.add_number("fov_deg", viewpoint.fov_rad * 180.0 / std::numbers::pi).text();
    });
    list("panels", scene_.looks.panels,
         [&](const Panel& panel) { return yaml_text(output_.add_file(panel.name + ".json", panel.text)); });
  }

  static std::string light_text(const Light& light) {
    constexpr const char* kKinds[] = {"ambient", "directional", "point", "spot"};
    const bool placed = light.kind == LightKind::kPoint || light.kind == LightKind::kSpot;
    const bool aimed = light.kind == LightKind::kDirectional || light.kind == LightKind::kSpot;
    YamlMap map;
    map.add_text("kind", kKinds[static_cast<std::size_t>(light.kind)]);
    if (!light.name.empty()) map.add_text("name", light.name);
    map.add("color", yaml_list(light.color.data(), 4)).add_number("intensity", light.intensity);
    if (placed) map.add("position", yaml_list(light.position));
    if (aimed) map.add("direction", yaml_list(light.direction));
    if (light.kind == LightKind::kSpot)
      map.add_number("angle_deg", light.angle_rad * 180.0 / std::numbers::pi);
    if (light.shadows) map.add("shadows", "true");
    return map.text();
  }

  const Scene& scene_;
  const world::WorldModel& world_;
  Output& output_;
  std::string text_;
};

}  // namespace

std::vector<std::pair<std::string, std::string>> settings_of(const Scene& scene) {
  YamlMap surfaces;
  for (const auto& surface : scene.world.surfaces) surfaces.add(surface.name, surface_text(surface));
  std::vector<std::pair<std::string, std::string>> settings{
      {"name", yaml_text(scene.name)},
      {"gravity", yaml_list(scene.world.gravity)},
      {"tick_ms", exact(static_cast<double>(scene.world.tick_ns) / kNsPerMs)},
      {"clock", std::string(name_of(scene.clock))},
      {"speed", exact(scene.speed)},
      {"seed", std::to_string(scene.seed)},
      {"lockstep_timeout_s", exact(static_cast<double>(scene.lockstep_timeout_ns) / kNsPerS)},
      {"engine", engine_text(scene, 0)}};
  YamlMap collision;
  if (scene.world.collision_stage == world::CollisionKind::kFcl) collision.add("stage", "fcl");
  if (!scene.world.continuous_collision) collision.add("continuous", "false");
  if (scene.world.collision_work_limit != world::kCollisionWorkLimit)
    collision.add("work_limit", std::to_string(scene.world.collision_work_limit));
  if (!collision.empty()) settings.emplace_back("collision", collision.text());
  if (const std::string others = engines_text(scene); !others.empty())
    settings.emplace_back("engines", others);
  settings.emplace_back("surfaces", surfaces.text());
  return settings;
}

std::string to_yaml(const Scene& scene, Output& output) {
  return "# Written by visum convert from " + scene.file.filename().string() + "\n" +
         YamlWriter(scene, output).text();
}

}  // namespace visum::scene
