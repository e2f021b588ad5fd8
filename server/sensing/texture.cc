#include "server/sensing/texture.h"

#include <cmath>

#include "protocol/config/config.h"
#include "server/sensing/read_picture.h"
#include "server/world/trig.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 6.28318530717958647693;
constexpr double kPlaneCorner_m = -30.0;  // of what the page shows of a plane

// How far about the axis, m: from -y to the left, as the page's cylinders have it.
double around(const Vector3d& p, double radius) {
  const double angle = world::arc_tangent(p.x(), -p.y());
  return radius * (angle < 0.0 ? angle + kTwoPi : angle);
}

// Each face for itself, as seen from outside.
std::array<double, 2> place_on_box(const Vector3d& half, const Vector3d& p, const Vector3d& normal) {
  int axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  const bool front = normal[axis] > 0.0;
  const Vector3d low = p + half, high = half - p;
  if (axis == 0) return {front ? high.z() : low.z(), low.y()};
  if (axis == 1) return {low.x(), front ? high.z() : low.z()};
  return {front ? low.x() : high.x(), low.y()};
}

// The poles of a ball lie on its y axis, as the page's do.
std::array<double, 2> place_on_ball(double radius, const Vector3d& p) {
  const double about = world::arc_tangent(p.z(), -p.x());
  const double off_axis = std::sqrt(p.x() * p.x() + p.z() * p.z());
  const double from_bottom = kTwoPi / 2 - world::arc_tangent(off_axis, p.y());
  return {radius * (about < 0.0 ? about + kTwoPi : about), radius * from_bottom};
}

}  // namespace

Texture::Texture(const scene::Texture& file) {
  Picture picture;
  const std::string fault = read_picture(file.content_type, file.bytes, kMaxTextureSide, kMaxTexels, picture);
  if (!fault.empty())
    throw config::ConfigError({file.name, 0, ""}, "a camera cannot read this picture: " + fault);
  width_ = picture.width;
  height_ = picture.height;
  rgb_ = std::move(picture.rgb);
}

Vector3d Texture::pixel(int column, int row) const {
  column = (column % width_ + width_) % width_;
  row = (row % height_ + height_) % height_;
  const std::uint8_t* rgb = &rgb_[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                                       static_cast<std::size_t>(column))];
  return Vector3d(rgb[0], rgb[1], rgb[2]) / 255.0;
}

Vector3d Texture::at(double u, double v) const {
  const double x = (u - std::floor(u)) * width_ - 0.5, y = (1.0 - (v - std::floor(v))) * height_ - 0.5;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const double right = x - column, down = y - row;
  return (1.0 - down) * ((1.0 - right) * pixel(column, row) + right * pixel(column + 1, row)) +
         down * ((1.0 - right) * pixel(column, row + 1) + right * pixel(column + 1, row + 1));
}

std::optional<std::array<double, 2>> place_on(const world::Shape& shape, const Vector3d& p_S,
                                              const Vector3d& normal_S) {
  const double radius = shape.size[0];
  switch (shape.kind) {
    case world::ShapeKind::kPlane:
      return std::array{p_S.x() - kPlaneCorner_m, p_S.y() - kPlaneCorner_m};
    case world::ShapeKind::kBox:
      return place_on_box(Vector3d(shape.size[0], shape.size[1], shape.size[2]) / 2, p_S, normal_S);
    case world::ShapeKind::kSphere:
      return place_on_ball(radius, p_S);
    case world::ShapeKind::kCylinder:
      if (std::abs(normal_S.z()) > 0.5) return std::array{p_S.x() + radius, p_S.y() + radius};
      return std::array{around(p_S, radius), p_S.z() + shape.size[1] / 2};
    case world::ShapeKind::kCapsule:
      return std::array{around(p_S, radius), p_S.z() + shape.size[1] / 2 + radius};
    case world::ShapeKind::kConvex:
    case world::ShapeKind::kMesh:
      break;
  }
  return {};
}

}  // namespace visum::sensing
