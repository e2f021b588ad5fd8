// Paints a camera's picture: casts a ray for each pixel, and shades what it meets by the scene's lights,
// colours and textures. A picture depends on the reading alone. The painter has a model and rays of its own,
// so it may live on any one thread; a CameraRenderer owns it. The constructor throws where a texture cannot
// be read.
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

  // Writes a header and the pixels (hwparts/sensors/camera.h). `image` must have their size. Without a
  // reading, as before the first one, all pixels are 0.
  void paint(std::span<const double> reading, std::span<std::byte> image);

  // Makes the reading from a state: the time in ns, then 7 numbers per body (p_WC, then q_WB as w x y z).
  static void read(const Moment& moment, std::span<double> reading);

 private:
  using Color = Eigen::Vector3d;  // red, green, blue; 1 is white

  // Puts the bodies where the reading has them.
  void place(std::span<const double> reading);
  // Reads the textures that some shape wears, each once.
  void cover_shapes(const scene::Looks& looks);
  // The surface's colour in white light: the shape's colour times its texture.
  Color own_color_of(const Hit& hit, const Ray& ray) const;
  // The colour that the camera sees, with lights and exposure.
  Color color_of(const Hit& hit, const Ray& ray) const;
  // How much of a light falls on a point of a surface, 0 in its shadow.
  double light_on(const scene::Light& light, const Eigen::Vector3d& p_W,
                  const Eigen::Vector3d& normal_W) const;
  // Write one pixel, with the camera's noise where it has any.
  void put_color(const Color& color, sensors::Random& random, std::byte* to) const;
  void put_depth(double depth_m, sensors::Random& random, std::byte* to) const;
  void put_body(const Hit& hit, std::byte* to) const;

  const world::WorldModel model_;
  const std::vector<scene::Light> lights_;
  // The texture on a shape.
  struct Cover {
    std::int32_t texture = -1;  // index into textures_; -1: the shape's colour alone
    std::array<double, 2> tile_m{1.0, 1.0};
  };
  std::vector<Cover> covers_;  // by ShapeId
  std::vector<Texture> textures_;
  const Mount mount_;
  const sensors::CameraSettings settings_;
  const double pixel_at_1m_;                   // m: the width that one pixel covers of a wall 1 m ahead
  std::vector<Eigen::Vector3d> directions_C_;  // by pixel, unit
  RayWorld rays_;                              // of model_
  world::WorldState state_;
};

}  // namespace visum::sensing
