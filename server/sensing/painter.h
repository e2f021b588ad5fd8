// Paints a camera's picture: which way each pixel looks, what it meets there, and how the scene's lights fall
// on it, and on the pictures that cover it. Has a world of its own to look into, so that it may live on any
// thread. A function of the reading alone.
#pragma once

#include <vector>

#include "hwparts/sensors/camera.h"
#include "server/scene/scene.h"
#include "server/sensing/probe.h"
#include "server/sensing/texture.h"

namespace visum::sensing {

class Painter {
 public:
  Painter(const scene::Scene& scene, const Mount& mount, const sensors::CameraSettings& settings);

  // A header, then the pixels (hwparts/sensors/camera.h). `image` has their size; all 0 where there is no
  // reading yet.
  void paint(std::span<const double> reading, std::span<std::byte> image);

  // The reading of a state, as Camera wants it.
  static void read(const Moment& moment, std::span<double> reading);

 private:
  using Color = Eigen::Vector3d;  // red, green, blue; 1 is white

  void place(std::span<const double> reading);
  void cover_shapes(const scene::Looks& looks);
  Color own_color_of(const Hit& hit, const Ray& ray) const;
  Color color_of(const Hit& hit, const Ray& ray) const;
  double light_on(const scene::Light& light, const Eigen::Vector3d& p_W,
                  const Eigen::Vector3d& normal_W) const;
  void put_color(const Color& color, sensors::Random& random, std::byte* to) const;
  void put_depth(double depth_m, sensors::Random& random, std::byte* to) const;
  void put_body(const Hit& hit, std::byte* to) const;

  const world::WorldModel model_;
  const std::vector<scene::Light> lights_;
  // What lies on each shape, by ShapeId; without a texture: its colour alone.
  struct Cover {
    std::int32_t texture = -1;  // index into textures_
    std::array<double, 2> tile_m{1.0, 1.0};
  };
  std::vector<Cover> covers_;
  std::vector<Texture> textures_;
  const Mount mount_;
  const sensors::CameraSettings settings_;
  const double pixel_at_1m_;                   // m, how much of a wall 1 m ahead one pixel covers
  std::vector<Eigen::Vector3d> directions_C_;  // by pixel, unit
  RayWorld rays_;                              // of model_
  world::WorldState state_;
};

}  // namespace visum::sensing
