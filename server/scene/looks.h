// The looks of a scene: materials, lights, viewpoints, and panels of the page. Viewers use them; the world
// does not know them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace visum::scene {

struct Texture {
  std::string name;          // the file's name
  std::string content_type;  // image/png, image/jpeg
  std::string bytes;         // the file's content
};

struct Material {
  std::string name;
  std::array<double, 4> color{0.7, 0.7, 0.7, 1.0};
  double roughness = 0.6;  // 0: a mirror, 1: chalk
  double metalness = 0.0;
  std::int32_t texture = -1;                       // index into Looks::textures; -1: none
  std::array<double, 2> texture_size_m{1.0, 1.0};  // size of one tile

  bool operator==(const Material&) const = default;
};

enum class LightKind { kAmbient, kDirectional, kPoint, kSpot };

struct Light {
  std::string name;
  LightKind kind = LightKind::kDirectional;
  std::array<double, 4> color{1.0, 1.0, 1.0, 1.0};
  double intensity = 1.0;                              // 1: as bright as white paper in full light
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // point, spot; in W
  Eigen::Vector3d direction =
      -Eigen::Vector3d::UnitZ();  // directional, spot: where it shines; in W, unit vector
  double angle_rad = 0.5;         // spot: half the angle of its cone
  bool shadows = false;
};

struct Viewpoint {
  std::string name;
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), target = Eigen::Vector3d::Zero();  // in W
  double fov_rad = 0.7;                                                                  // vertical
};

struct Panel {
  std::string name;
  std::string text;  // JSON; the page knows its meaning
};

struct Looks {
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Light> lights;
  std::vector<Viewpoint> viewpoints;
  std::vector<Panel> panels;
};

inline constexpr std::size_t kMaxMaterials = 1000;
inline constexpr std::size_t kMaxLights = 16;
inline constexpr std::size_t kMaxViewpoints = 64;
inline constexpr std::size_t kMaxPanels = 16;
inline constexpr std::size_t kMaxTextureBytes = 16u << 20;  // of one file
inline constexpr std::size_t kMaxAllTextureBytes = 64u << 20;
inline constexpr std::size_t kMaxPanelBytes = 256u << 10;

}  // namespace visum::scene
