// The kind `camera`: pictures of colours, of depths, or of bodies, on the blackboard `image`. The sensor's
// reading says when a picture was taken and where all bodies were then. server/sensing, which knows the
// world, paints the picture from that reading, off the tick.
//
// The camera looks along +x of its frame, with z up: columns go to the right (-y), rows down.
#pragma once

#include <array>
#include <memory>

#include "hwparts/sensors/sensor.h"

namespace visum::sensors {

enum class Shows { kColor, kDepth, kSegmentation };

// A pinhole camera with radial distortion (Brown's: x_d = x (1 + k1 r² + k2 r⁴), in units of the focal
// length).
struct Lens {
  int width = 0, height = 0;  // pixels
  double fov_rad = 0.0;       // horizontal, without distortion
  double k1 = 0.0, k2 = 0.0;
};

struct CameraSettings {
  Shows shows = Shows::kColor;
  Lens lens;
  double farthest_m = 0.0;   // the camera sees nothing beyond
  double exposure = 1.0;     // colours: factor on the light
  double noise = 0.0;        // colours: share of white; depth: m. Standard deviation of each value
  double noise_share = 0.0;  // depth: standard deviation as a share of it
  std::uint64_t seed = 1;
  std::string name;
};

// Throws ConfigError.
CameraSettings read_camera(const config::Node& entry, const std::string& name, std::uint64_t seed);

// The direction in which a point of the picture looks, in the camera's frame, with x = 1. The point is in
// pixels: (0, 0) is the picture's corner, (0.5, 0.5) the middle of its first pixel.
std::array<double, 3> direction_of(const Lens& lens, double column, double row);
// The reverse: the place on the picture of a point of the camera's frame with x > 0.
std::array<double, 2> pixel_of(const Lens& lens, const std::array<double, 3>& point);

// The header on the blackboard. The pixels follow it, row by row from the top. Little-endian.
struct ImageHeader {
  std::uint32_t bytes = sizeof(ImageHeader);
  std::uint32_t width = 0, height = 0;
  std::uint32_t shows = 0;     // 0: colours, 3 bytes RGB; 1: depth, a 32-bit float, m; 2: bodies, 16 bits
  std::int64_t taken_ns = -1;  // simulated time; -1: no picture yet, all pixels are 0
};
std::size_t pixels_of(const Lens& lens);
std::size_t bytes_per_pixel(Shows shows);
std::size_t image_bytes(const CameraSettings& settings);  // with the header
inline constexpr int kMaxSide = 4096;
inline constexpr int kMaxPixels = 4'194'304;
// The limit for all cameras of a scene together, since each pixel costs some 40 bytes.
inline constexpr std::size_t kMaxPixelsInAll = 4 * static_cast<std::size_t>(kMaxPixels);

// Makes pictures from readings; server/sensing implements it. expose() never waits.
class PictureMaker {
 public:
  virtual ~PictureMaker() = default;
  virtual void expose(std::span<const double> reading) = 0;
  virtual std::span<const std::byte> picture() = 0;  // the newest one
};

// Lives on the tick's thread, as all sensors do.
class Camera : public Sensor {
 public:
  Camera(const SensorContext& context, const CameraSettings& settings);

  // Sets the size of the reading and its picture maker. A reading is first the time in ns (0: none yet), then
  // 7 numbers for each body: x y z qw qx qy qz. Called before the first tick, and again when bodies have come
  // or gone; readings on their way are lost then. `picture_maker` must outlive the camera, or be replaced.
  void bind_renderer(std::size_t bodies, PictureMaker& picture_maker);

  std::size_t pixels() const { return pixels_; }

  std::span<const std::byte> read_blackboard(std::size_t index) const override;

 protected:
  void show(std::span<const double> reading, std::span<double> outputs) override;
  void shown_again(std::span<const double> reading) override;
  const char* why_not(Failure failure) const override;
  bool fills_blackboard() const override { return true; }

 private:
  std::size_t pixels_;
  PictureMaker* picture_maker_ = nullptr;
};

std::unique_ptr<Sensor> make_camera(const SensorContext& context);

}  // namespace visum::sensors
