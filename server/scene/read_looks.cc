#include "server/scene/read_looks.h"

#include <algorithm>
#include <numbers>

#include "protocol/config/read_file.h"
#include "server/scene/frames.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;

constexpr config::Range kShare{0.0, 1.0};
constexpr config::Range kIntensity{0.0, 1000.0};
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Decides by the first bytes and not by the name, as browsers do.
std::string picture_type(const std::string& bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return "image/png";
  if (bytes.starts_with("\xff\xd8\xff")) return "image/jpeg";
  return {};
}

std::string read_bytes(const Node& node, std::size_t max_bytes) {
  const auto path = read_path(node);
  config::FileContent content = config::read_file(path, max_bytes);
  if (!content.fault.empty()) node.fail("'" + path.string() + "': " + content.fault);
  return std::move(content.bytes);
}

std::int32_t read_texture(Looks& looks, const Node& node) {
  const std::string name = read_path(node).string();
  Texture texture{name, {}, read_bytes(node, kMaxTextureBytes)};
  // Two models that came while the world runs may have other files of the same name.
  const auto known = std::ranges::find_if(looks.textures, [&](const Texture& other) {
    return other.name == name && other.bytes == texture.bytes;
  });
  if (known != looks.textures.end()) return static_cast<std::int32_t>(known - looks.textures.begin());
  texture.content_type = picture_type(texture.bytes);
  if (texture.content_type.empty()) node.fail("'" + name + "' is neither a PNG nor a JPEG picture");
  std::size_t total = texture.bytes.size();
  for (const Texture& other : looks.textures) total += other.bytes.size();
  if (total > kMaxAllTextureBytes)
    node.fail("all textures together have more than " + std::to_string(kMaxAllTextureBytes >> 20) + " MiB");
  looks.textures.push_back(std::move(texture));
  return static_cast<std::int32_t>(looks.textures.size() - 1);
}

Material read_material(Looks& looks, const std::string& name, const Node& node) {
  node.allow_only({"color", "roughness", "metalness", "texture", "texture_size"});
  Material material;
  material.name = name;
  if (const auto texture = node.find("texture")) {
    material.texture = read_texture(looks, *texture);
    material.color = {1.0, 1.0, 1.0, 1.0};  // a picture brings its own colours
  }
  if (const auto color = node.find("color")) material.color = read_color(*color);
  material.roughness = node.number_or("roughness", material.roughness, kShare);
  material.metalness = node.number_or("metalness", material.metalness, kShare);
  if (const auto size = node.find("texture_size")) {
    if (material.texture < 0) size->fail("needs 'texture' beside it");
    const auto lengths = size->numbers(2, kSize);
    material.texture_size_m = {lengths[0], lengths[1]};
  }
  return material;
}

LightKind read_light_kind(const Node& node) {
  const std::string word = node.one_of({"ambient", "directional", "point", "spot"});
  if (word == "ambient") return LightKind::kAmbient;
  if (word == "point") return LightKind::kPoint;
  return word == "spot" ? LightKind::kSpot : LightKind::kDirectional;
}

// Refuses a key that lights of this kind do not have.
void refuse(const Node& light, const char* key, bool means_something) {
  if (const auto node = light.find(key); node && !means_something)
    node->fail("means nothing for a light of this kind");
}

}  // namespace

void read_materials(Draft& draft, const Node& root) {
  const auto list = root.find("materials");
  if (!list) return;
  Looks& looks = draft.scene.looks;
  for (const std::string& name : list->keys()) {
    const Node node = list->get(name);
    if (const std::string fault = name_fault(name); !fault.empty()) node.fail("a material's name " + fault);
    const Material material = read_material(looks, name, node);
    if (std::ranges::find(looks.materials, material) != looks.materials.end())
      continue;  // the same material again, from another include
    draft.claim("material", name, node.place());
    if (looks.materials.size() == kMaxMaterials)
      node.fail("there are more than " + std::to_string(kMaxMaterials) + " materials");
    looks.materials.push_back(material);
  }
}

void read_light(Draft& draft, const Node& node) {
  node.allow_only({"name", "kind", "color", "intensity", "position", "direction", "angle_deg", "shadows"});
  auto& lights = draft.scene.looks.lights;
  if (lights.size() == kMaxLights) node.fail("there are more than " + std::to_string(kMaxLights) + " lights");
  Light light;
  light.kind = read_light_kind(node.get("kind"));
  const bool has_place = light.kind == LightKind::kPoint || light.kind == LightKind::kSpot;
  const bool has_direction = light.kind == LightKind::kDirectional || light.kind == LightKind::kSpot;
  refuse(node, "position", has_place);
  refuse(node, "direction", has_direction);
  refuse(node, "angle_deg", light.kind == LightKind::kSpot);
  refuse(node, "shadows", light.kind != LightKind::kAmbient);
  if (const auto name = node.find("name")) light.name = read_name(*name);
  if (const auto color = node.find("color")) light.color = read_color(*color);
  light.intensity = node.number_or("intensity", light.intensity, kIntensity);
  if (has_place) light.position = point_in_world(draft, read_vector(node.get("position")));
  if (has_direction) light.direction = direction_in_world(draft, read_axis(node.get("direction")));
  light.angle_rad = node.number_or("angle_deg", light.angle_rad / kRadPerDeg, {1.0, 89.0}) * kRadPerDeg;
  light.shadows = node.boolean_or("shadows", false);
  lights.push_back(light);
}

void read_viewpoint(Draft& draft, const Node& node) {
  node.allow_only({"name", "position", "target", "fov_deg"});
  auto& viewpoints = draft.scene.looks.viewpoints;
  if (viewpoints.size() == kMaxViewpoints)
    node.fail("there are more than " + std::to_string(kMaxViewpoints) + " viewpoints");
  Viewpoint viewpoint;
  viewpoint.name = read_name(node.get("name"));
  draft.claim("viewpoint", viewpoint.name, node.place());
  viewpoint.position = point_in_world(draft, read_vector(node.get("position")));
  viewpoint.target = point_in_world(draft, read_vector(node.get("target")));
  viewpoint.fov_rad = node.number_or("fov_deg", viewpoint.fov_rad / kRadPerDeg, {5.0, 120.0}) * kRadPerDeg;
  if ((viewpoint.position - viewpoint.target).norm() < 1e-6)
    node.fail("'position' and 'target' must not be the same point");
  viewpoints.push_back(viewpoint);
}

// JSON is YAML, so errors have a place in the panel's own file. The page knows what the widgets mean.
void read_panel(Draft& draft, const Node& node) {
  auto& panels = draft.scene.looks.panels;
  if (panels.size() == kMaxPanels) node.fail("there are more than " + std::to_string(kMaxPanels) + " panels");
  Panel panel{{}, read_bytes(node, kMaxPanelBytes)};
  const Node root = config::load_file(read_path(node));
  root.get("visum_panel").integer(1, 1);
  panel.name = root.get("name").text();
  root.get("widgets").size();
  draft.claim("panel", panel.name, node.place());
  panels.push_back(std::move(panel));
}

}  // namespace visum::scene
