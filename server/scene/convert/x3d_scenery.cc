#include "server/scene/convert/x3d_scenery.h"

#include <algorithm>

#include "server/scene/convert/x3d_robot.h"
#include "server/scene/convert/x3d_text.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

class SceneryReader {
 public:
  SceneryReader(Draft& draft, X3dShapes& shapes, const std::set<const X3dNode*>& of_bodies)
      : draft_(draft), shapes_(shapes), of_bodies_(of_bodies) {}

  void walk(const X3dNode& given, const X3dFrame& frame, bool collides, int depth) {
    const X3dNode& node = shapes_.resolved(given);
    if (depth > kMaxX3dTreeDepth)
      shapes_.fail(given, "nodes are nested more than " + std::to_string(kMaxX3dTreeDepth) + " deep");
    if (++visits_ > kMaxX3dNodes)
      shapes_.fail(given,
                   "with every USE written out it has more than " + std::to_string(kMaxX3dNodes) + " nodes");
    if (node.type == "RigidBodyCollection" || node.type == "CollisionCollection") return;
    if (is_x3d_robot(node)) {
      robots_.push_back({&node, frame});
      return;
    }
    if (node.type == "Shape") {
      if (!of_bodies_.contains(&node)) shapes_.add(node, scenery(node), frame, collides, {});
      return;
    }
    add_looks(node, frame);
    const X3dFrame inner = node.type == "Transform" ? shapes_.inside(node, frame) : frame;
    if (node.type == "Collision")
      collides = collides &&
                 flag_of(node, "enabled", flag_of(node, "collide", true, shapes_.file()), shapes_.file());
    for (const X3dNode* child : shapes_.shown(node)) walk(*child, inner, collides, depth + 1);
  }

  // Call it after walk(), so that the shapes of each body stand together.
  std::size_t read_robots() {
    for (const auto& [node, frame] : robots_) read_x3d_robot(draft_, shapes_, *node, frame);
    return robots_.size();
  }

 private:
  world::BodyId scenery(const X3dNode& first) {
    if (scenery_.valid()) return scenery_;
    world::Body body;
    body.name = "scenery";
    body.fixed = true;
    return scenery_ = draft_.add_body(body, shapes_.place_of(first));
  }

  void add_looks(const X3dNode& node, const X3dFrame& frame) {
    auto& looks = draft_.scene.looks;
    if (node.type == "Viewpoint" && looks.viewpoints.size() < kMaxViewpoints) {
      Viewpoint viewpoint;
      const auto name = node.values.find("description");
      viewpoint.name = name == node.values.end() || !name_fault(name->second).empty()
                           ? "viewpoint_" + std::to_string(looks.viewpoints.size())
                           : name->second;
      viewpoint.position = frame * shapes_.vector(node, "position", {0, 0, 10});
      const Eigen::Vector3d ahead =
          frame.X.q * (shapes_.rotation(node, "orientation") * -Eigen::Vector3d::UnitZ());
      viewpoint.target = viewpoint.position + ahead;
      viewpoint.fov_rad =
          std::clamp(numbers_of(node, "fieldOfView", 1, {0.7854}, shapes_.file())[0], 0.09, 2.09);
      looks.viewpoints.push_back(viewpoint);
    }
    const bool directional = node.type == "DirectionalLight", spot = node.type == "SpotLight";
    if ((!directional && !spot && node.type != "PointLight") || looks.lights.size() == kMaxLights) return;
    Light light;
    light.kind = directional ? LightKind::kDirectional : spot ? LightKind::kSpot : LightKind::kPoint;
    light.intensity = numbers_of(node, "intensity", 1, {1.0}, shapes_.file())[0];
    const double ambient = numbers_of(node, "ambientIntensity", 1, {0.0}, shapes_.file())[0];
    if (directional && light.intensity == 0.0 && ambient > 0.0) {
      light.kind = LightKind::kAmbient;
      light.intensity = ambient;
    }
    const auto rgb = numbers_of(node, "color", 3, {1, 1, 1}, shapes_.file());
    for (std::size_t i = 0; i < 3; ++i) light.color[i] = std::clamp(rgb[i], 0.0, 1.0);
    light.position = frame * shapes_.vector(node, "location", Eigen::Vector3d::Zero());
    const Eigen::Vector3d direction = shapes_.vector(node, "direction", -Eigen::Vector3d::UnitZ());
    if (!(direction.norm() > 1e-6)) shapes_.fail(node, "direction must not be zero");
    light.direction = (frame.X.q * direction).normalized();
    light.angle_rad =
        std::clamp(numbers_of(node, "cutOffAngle", 1, {0.785398}, shapes_.file())[0], 0.01, 1.57);
    looks.lights.push_back(light);
  }

  Draft& draft_;
  X3dShapes& shapes_;
  const std::set<const X3dNode*>& of_bodies_;
  world::BodyId scenery_;
  std::vector<std::pair<const X3dNode*, X3dFrame>> robots_;
  std::size_t visits_ = 0;
};

}  // namespace

std::size_t read_x3d_scenery(Draft& draft, X3dShapes& shapes, const X3dNode& root,
                             const std::set<const X3dNode*>& of_bodies) {
  SceneryReader reader(draft, shapes, of_bodies);
  reader.walk(root, {}, true, 0);
  return reader.read_robots();
}

}  // namespace visum::scene
