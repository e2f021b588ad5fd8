#include "server/sensing/painter.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "protocol/config/trig.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;
using scene::Light;
using scene::LightKind;

constexpr double kOffSurface =
    1e-6;                          // a shadow's ray begins so far off the surface, as a share of the distance
constexpr double kGrazing = 1e-3;  // flatter rays count as if this were their sine to the surface
constexpr double kEndless_m = 1e6;  // length of a ray to a light that is infinitely far away

// The lights of a scene that names none: an ambient light, a sun, and a weak light from the other side.
std::vector<Light> studio() {
  Light sky, sun, back;
  sky.kind = LightKind::kAmbient;
  sky.intensity = 0.35;
  sun.direction = Vector3d(0.4, 0.5, -1.0).normalized();
  sun.intensity = 0.6;
  sun.shadows = true;
  back.direction = Vector3d(-0.6, -0.4, -0.3).normalized();
  back.intensity = 0.15;
  return {sky, sun, back};
}

Vector3d vector_at(std::span<const double> numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

double pixel_at_1m(const sensors::Lens& lens) {
  const auto half = config::sin_cos(lens.fov_rad / 2.0);
  return 2.0 * half.sin / half.cos / lens.width;
}

std::byte as_byte(double share) {
  return static_cast<std::byte>(static_cast<unsigned char>(std::clamp(share * 255.0 + 0.5, 0.0, 255.0)));
}

}  // namespace

Painter::Painter(const scene::Scene& scene, const Mount& mount, const sensors::CameraSettings& settings)
    : model_(scene.world),
      lights_(scene.looks.lights.empty() ? studio() : scene.looks.lights),
      mount_(mount),
      settings_(settings),
      pixel_at_1m_(pixel_at_1m(settings.lens)),
      rays_(model_),
      state_(world::initial_state(model_)) {
  covers_.resize(model_.shapes.size());
  if (settings_.shows == sensors::Shows::kColor) cover_shapes(scene.looks);
  const sensors::Lens& lens = settings_.lens;
  for (int row = 0; row < lens.height; ++row) {
    for (int column = 0; column < lens.width; ++column) {
      const auto d = sensors::direction_of(lens, column + 0.5, row + 0.5);
      directions_C_.push_back(Vector3d(d[0], d[1], d[2]).normalized());
    }
  }
}

void Painter::cover_shapes(const scene::Looks& looks) {
  std::map<std::int32_t, std::int32_t> known;  // from the scene's textures to ours
  for (std::size_t i = 0; i < covers_.size(); ++i) {
    const std::int32_t number = model_.shapes[i].material;
    if (number < 0) continue;
    const scene::Material& material = looks.materials[static_cast<std::size_t>(number)];
    if (material.texture < 0) continue;
    const auto [entry, is_new] =
        known.try_emplace(material.texture, static_cast<std::int32_t>(textures_.size()));
    if (is_new) textures_.emplace_back(looks.textures[static_cast<std::size_t>(material.texture)]);
    covers_[i] = {entry->second, material.texture_size_m};
  }
}

void Painter::read(const Moment& moment, std::span<double> reading) {
  reading[0] = static_cast<double>(moment.now.tick * moment.model.tick_ns);
  double* to = reading.data() + 1;
  for (const world::BodyState& body : moment.now.bodies)
    for (const double number : {body.p_WC.x(), body.p_WC.y(), body.p_WC.z(), body.q_WB.w(), body.q_WB.x(),
                                body.q_WB.y(), body.q_WB.z()})
      *to++ = number;
}

void Painter::place(std::span<const double> reading) {
  for (std::size_t i = 0; i < state_.bodies.size(); ++i) {
    const auto numbers = reading.subspan(1 + 7 * i, 7);
    state_.bodies[i].p_WC = vector_at(numbers);
    state_.bodies[i].q_WB = {numbers[3], numbers[4], numbers[5], numbers[6]};
  }
  rays_.place(state_);
}

double Painter::light_on(const Light& light, const Vector3d& p_W, const Vector3d& normal_W) const {
  if (light.kind == LightKind::kAmbient) return light.intensity;
  Vector3d to_light = -light.direction;
  double length = kEndless_m;
  if (light.kind != LightKind::kDirectional) {
    length = (light.position - p_W).norm();
    if (length == 0.0) return 0.0;
    to_light = (light.position - p_W) / length;
    if (light.kind == LightKind::kSpot &&
        -to_light.dot(light.direction) < config::sin_cos(light.angle_rad).cos)
      return 0.0;
  }
  const double falls = normal_W.dot(to_light);
  if (falls <= 0.0) return 0.0;
  if (light.shadows && rays_.blocked({p_W, to_light, length, {}})) return 0.0;
  return light.intensity * falls;
}

Painter::Color Painter::own_color_of(const Hit& hit, const Ray& ray) const {
  const world::Shape& shape = model_.shapes[hit.shape.index()];
  const Color color(shape.color[0], shape.color[1], shape.color[2]);
  const Cover& cover = covers_[hit.shape.index()];
  if (cover.texture < 0) return color;
  const std::size_t body = shape.body.index();
  const world::Pose X_SW =
      (world::link_pose(model_.bodies[body], state_.bodies[body]) * shape.X_BS).inverse();
  const auto place =
      place_on(shape, X_SW * (ray.p_W + hit.distance_m * ray.direction_W), X_SW.q * hit.normal_W);
  if (!place) return color;
  // How much of the surface a pixel covers, in the direction in which it covers most.
  const double covers_m =
      pixel_at_1m_ * hit.distance_m / std::max(kGrazing, std::abs(hit.normal_W.dot(ray.direction_W)));
  const Texture& texture = textures_[static_cast<std::size_t>(cover.texture)];
  const auto& tile = cover.tile_m;
  return color.cwiseProduct(
      texture.at((*place)[0] / tile[0], (*place)[1] / tile[1], covers_m / std::min(tile[0], tile[1])));
}

Painter::Color Painter::color_of(const Hit& hit, const Ray& ray) const {
  const Vector3d p_W =
      ray.p_W + hit.distance_m * ray.direction_W + kOffSurface * (1.0 + hit.distance_m) * hit.normal_W;
  Color light = Color::Zero();
  for (const Light& one : lights_)
    light += light_on(one, p_W, hit.normal_W) * Color(one.color[0], one.color[1], one.color[2]);
  return settings_.exposure * light.cwiseProduct(own_color_of(hit, ray));
}

void Painter::put_color(const Color& color, sensors::Random& random, std::byte* to) const {
  for (int channel = 0; channel < 3; ++channel)
    to[channel] = as_byte(color[channel] + (settings_.noise > 0.0 ? settings_.noise * random.normal() : 0.0));
}

void Painter::put_depth(double depth_m, sensors::Random& random, std::byte* to) const {
  if (depth_m < settings_.farthest_m) {
    const double deviation = settings_.noise + settings_.noise_share * depth_m;
    if (deviation > 0.0)
      depth_m = std::clamp(depth_m + deviation * random.normal(), 0.0, settings_.farthest_m);
  }
  const auto value = static_cast<float>(depth_m);
  std::memcpy(to, &value, sizeof value);
}

void Painter::put_body(const Hit& hit, std::byte* to) const {
  std::uint16_t number = 0;
  if (hit.shape.valid()) number = static_cast<std::uint16_t>(model_.shapes[hit.shape.index()].body.value + 1);
  std::memcpy(to, &number, sizeof number);
}

void Painter::paint(std::span<const double> reading, std::span<std::byte> image) {
  std::ranges::fill(image, std::byte{0});
  sensors::ImageHeader header;
  header.width = static_cast<std::uint32_t>(settings_.lens.width);
  header.height = static_cast<std::uint32_t>(settings_.lens.height);
  header.shows = static_cast<std::uint32_t>(settings_.shows);
  const bool taken = !reading.empty() && reading[0] > 0.0;
  if (taken) header.taken_ns = static_cast<std::int64_t>(reading[0]);
  std::memcpy(image.data(), &header, sizeof header);
  if (!taken) return;
  place(reading);
  const world::Pose X_WC = pose_of(mount_, model_, state_);
  // The random numbers of a picture depend on its time alone, not on when or on which thread it is painted.
  sensors::Random random(settings_.seed ^ static_cast<std::uint64_t>(header.taken_ns), settings_.name);
  std::byte* to = image.data() + sizeof header;
  for (const Vector3d& direction_C : directions_C_) {
    const Ray ray{X_WC.p, X_WC.q * direction_C, settings_.farthest_m / direction_C.x(), mount_.body};
    const Hit hit = rays_.cast(ray);
    if (settings_.shows == sensors::Shows::kColor)
      put_color(hit.shape.valid() ? color_of(hit, ray) : Color::Zero(), random, to);
    else if (settings_.shows == sensors::Shows::kDepth)
      put_depth(hit.shape.valid() ? hit.distance_m * direction_C.x() : settings_.farthest_m, random, to);
    else
      put_body(hit, to);
    to += sensors::bytes_per_pixel(settings_.shows);
  }
}

}  // namespace visum::sensing
