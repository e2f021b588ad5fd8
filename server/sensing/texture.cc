#include "server/sensing/texture.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/config.h"
#include "protocol/config/trig.h"
#include "server/sensing/read_picture.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 6.28318530717958647693;
constexpr double kPlaneCorner_m = -30.0;  // x and y: the page shows a plane from this corner on

// The way around the axis, m, as the page lays pictures on cylinders: it begins at -y.
double around(const Vector3d& p, double radius) {
  const double angle = config::arc_tangent(p.x(), -p.y());
  return radius * (angle < 0.0 ? angle + kTwoPi : angle);
}

// Each face has the picture for itself, as seen from outside.
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
  const double about = config::arc_tangent(p.z(), -p.x());
  const double off_axis = std::sqrt(p.x() * p.x() + p.z() * p.z());
  const double from_bottom = kTwoPi / 2 - config::arc_tangent(off_axis, p.y());
  return {radius * (about < 0.0 ? about + kTwoPi : about), radius * from_bottom};
}

}  // namespace

Texture::Texture(const scene::Texture& file) {
  Picture picture;
  const std::string fault = read_picture(file.content_type, file.bytes, kMaxTextureSide, kMaxTexels, picture);
  if (!fault.empty())
    throw config::ConfigError({file.name, 0, ""}, "a camera cannot read this picture: " + fault);
  levels_.push_back({picture.width, picture.height, std::move(picture.rgb)});
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(half_of(levels_.back()));
}

// Each pixel is the mean of four, or of two where the picture is one pixel wide or high.
Texture::Level Texture::half_of(const Level& level) {
  Level half{std::max(1, level.width / 2), std::max(1, level.height / 2), {}};
  const auto at = [&](int column, int row, int channel) {
    return int{level.rgb[3 * (static_cast<std::size_t>(std::min(row, level.height - 1)) *
                                  static_cast<std::size_t>(level.width) +
                              static_cast<std::size_t>(std::min(column, level.width - 1))) +
                         static_cast<std::size_t>(channel)]};
  };
  for (int row = 0; row < half.height; ++row)
    for (int column = 0; column < half.width; ++column)
      for (int channel = 0; channel < 3; ++channel) {
        const int x = 2 * column, y = 2 * row;
        const int sum =
            at(x, y, channel) + at(x + 1, y, channel) + at(x, y + 1, channel) + at(x + 1, y + 1, channel);
        half.rgb.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
      }
  return half;
}

Vector3d Texture::pixel(const Level& level, int column, int row) {
  column = (column % level.width + level.width) % level.width;
  row = (row % level.height + level.height) % level.height;
  const std::uint8_t* rgb =
      &level.rgb[3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(level.width) +
                      static_cast<std::size_t>(column))];
  return Vector3d(rgb[0], rgb[1], rgb[2]) / 255.0;
}

Vector3d Texture::between(const Level& level, double u, double v) {
  const double x = (u - std::floor(u)) * level.width - 0.5;
  const double y = (1.0 - (v - std::floor(v))) * level.height - 0.5;
  const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const double right = x - column, down = y - row;
  return (1.0 - down) * ((1.0 - right) * pixel(level, column, row) + right * pixel(level, column + 1, row)) +
         down * ((1.0 - right) * pixel(level, column, row + 1) + right * pixel(level, column + 1, row + 1));
}

// Mixes two levels. The viewer's pixel covers 1 to 2 pixels of the first, and so lies between both in size.
Vector3d Texture::at(double u, double v, double across) const {
  double pixels = across * std::max(levels_[0].width, levels_[0].height);
  std::size_t level = 0;
  for (; pixels >= 2.0 && level + 1 < levels_.size(); ++level) pixels /= 2.0;
  const double rest = std::clamp(pixels - 1.0, 0.0, 1.0);
  const Vector3d color = between(levels_[level], u, v);
  if (rest == 0.0 || level + 1 == levels_.size()) return color;
  return (1.0 - rest) * color + rest * between(levels_[level + 1], u, v);
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
