#include "hwparts/sensors/camera.h"

#include <cmath>

#include "protocol/config/trig.h"

namespace visum::sensors {
namespace {

constexpr double kFarthest_m = 1e5;

Lens read_lens(const config::Node& entry) {
  Lens lens;
  const config::Node size = entry.get("size");
  if (size.size() != 2) size.fail("must be [width, height]");
  lens.width = static_cast<int>(size.at(0).integer(1, kMaxSide));
  lens.height = static_cast<int>(size.at(1).integer(1, kMaxSide));
  if (lens.width * lens.height > kMaxPixels)
    size.fail("a picture has at most " + std::to_string(kMaxPixels) + " pixels");
  lens.fov_rad = entry.get("fov_deg").number({1.0, 170.0}) * (3.14159265358979323846 / 180.0);
  if (const auto distortion = entry.find("distortion")) {
    const auto k = distortion->numbers(2, {-10.0, 10.0});
    lens.k1 = k[0];
    lens.k2 = k[1];
  }
  return lens;
}

double focal_length(const Lens& lens) {
  return lens.width / 2.0 / config::tangent(lens.fov_rad / 2);
}

double stretch(const Lens& lens, double square) {
  return 1.0 + square * (lens.k1 + lens.k2 * square);
}

// d/dr of r (1 + k1 r² + k2 r⁴). Where it is not positive, the lens folds the picture over itself.
double slope(const Lens& lens, double square) {
  return 1.0 + square * (3.0 * lens.k1 + 5.0 * lens.k2 * square);
}

// The undistorted radius for a distorted one, by Newton's method.
double straightened(const Lens& lens, double radius) {
  double r = radius;
  for (int i = 0; i < 20; ++i) r -= (r * stretch(lens, r * r) - radius) / slope(lens, r * r);
  return r;
}

// Refuses a lens that folds the picture before its corners.
void check_distortion(const config::Node& entry, const Lens& lens) {
  if (lens.k1 == 0.0 && lens.k2 == 0.0) return;
  const double corner = std::hypot(lens.width, lens.height) / 2 / focal_length(lens);
  double r = 0.0;
  constexpr int kSteps = 1000;
  const double step = corner / kSteps;
  while (r * stretch(lens, r * r) < corner) {
    if (slope(lens, r * r) <= 0.05 || r > 100 * corner)
      entry.get("distortion").fail("folds the picture over itself before its corners");
    r += step;
  }
}

Shows read_shows(const config::Node& entry) {
  const auto node = entry.find("shows");
  if (!node) return Shows::kColor;
  const std::string word = node->one_of({"color", "depth", "segmentation"});
  return word == "color" ? Shows::kColor : word == "depth" ? Shows::kDepth : Shows::kSegmentation;
}

const char* content_type(Shows shows) {
  switch (shows) {
    case Shows::kColor:
      return "application/x-visum-image;shows=color";
    case Shows::kDepth:
      return "application/x-visum-image;shows=depth";
    case Shows::kSegmentation:
      return "application/x-visum-image;shows=segmentation";
  }
  return "";
}

}  // namespace

CameraSettings read_camera(const config::Node& entry, const std::string& name, std::uint64_t seed) {
  allow_keys(entry, {"body", "pose", "shows", "size", "fov_deg", "distortion", "far", "exposure", "noise",
                     "noise_share"});
  CameraSettings settings;
  settings.shows = read_shows(entry);
  settings.lens = read_lens(entry);
  check_distortion(entry, settings.lens);
  settings.farthest_m = entry.number_or("far", 100.0, {0.0, kFarthest_m, true});
  settings.exposure = entry.number_or("exposure", 1.0, {0.0, 1e3, true});
  const bool depth = settings.shows == Shows::kDepth;
  for (const char* key : {"noise", "noise_share", "exposure"}) {
    const auto node = entry.find(key);
    if (!node) continue;
    const bool fits = std::string(key) == "noise"         ? settings.shows != Shows::kSegmentation
                      : std::string(key) == "noise_share" ? depth
                                                          : settings.shows == Shows::kColor;
    if (!fits) node->fail("a camera that shows this has none");
  }
  settings.noise = entry.number_or("noise", 0.0, {0.0, depth ? settings.farthest_m : 1.0});
  settings.noise_share = entry.number_or("noise_share", 0.0, {0.0, 1.0});
  settings.seed = seed;
  settings.name = name;
  return settings;
}

std::array<double, 3> direction_of(const Lens& lens, double column, double row) {
  const double f = focal_length(lens);
  const double right = (column - lens.width / 2.0) / f, down = (row - lens.height / 2.0) / f;
  const double radius = std::sqrt(right * right + down * down);
  const double shrink =
      radius > 0.0 && (lens.k1 != 0.0 || lens.k2 != 0.0) ? straightened(lens, radius) / radius : 1.0;
  return {1.0, -right * shrink, -down * shrink};
}

std::array<double, 2> pixel_of(const Lens& lens, const std::array<double, 3>& point) {
  const double right = -point[1] / point[0], down = -point[2] / point[0];
  const double f = focal_length(lens) * stretch(lens, right * right + down * down);
  return {lens.width / 2.0 + f * right, lens.height / 2.0 + f * down};
}

std::size_t bytes_per_pixel(Shows shows) {
  return shows == Shows::kColor ? 3 : shows == Shows::kDepth ? 4 : 2;
}

std::size_t pixels_of(const Lens& lens) {
  return static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
}

std::size_t image_bytes(const CameraSettings& settings) {
  return sizeof(ImageHeader) + pixels_of(settings.lens) * bytes_per_pixel(settings.shows);
}

Camera::Camera(const SensorContext& context, const CameraSettings& settings)
    : Sensor(context, Layout{"camera",
                             {},
                             {{"image", content_type(settings.shows), 1, image_bytes(settings),
                               image_bytes(settings), false}},
                             {}}),
      pixels_(pixels_of(settings.lens)) {}

void Camera::bind_renderer(std::size_t bodies, PictureMaker& picture_maker) {
  constexpr double kAny = std::numeric_limits<double>::max();
  picture_maker_ = &picture_maker;
  set_numbers(std::vector<Accuracy>(1 + 7 * bodies, Accuracy{-kAny, kAny}));
}

std::span<const std::byte> Camera::read_blackboard(std::size_t) const {
  return picture_maker_ ? picture_maker_->picture() : std::span<const std::byte>();
}

void Camera::show(std::span<const double> reading, std::span<double>) {
  shown_again(reading);
}

void Camera::shown_again(std::span<const double> reading) {
  if (picture_maker_) picture_maker_->expose(reading);
}

const char* Camera::why_not(Failure failure) const {
  return failure == Failure::kGarbage || failure == Failure::kWrong ? "a camera does not fail in this way"
                                                                    : nullptr;
}

std::unique_ptr<Sensor> make_camera(const SensorContext& context) {
  auto camera = std::make_unique<Camera>(context, read_camera(context.config, context.name, context.seed));
  if (const auto failure = context.config.find("failure"))
    if (const auto reason = camera->set_parameter("Failure", failure->text())) failure->fail(*reason);
  return camera;
}

}  // namespace visum::sensors
