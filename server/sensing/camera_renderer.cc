#include "server/sensing/camera_renderer.h"

#include <algorithm>

namespace visum::sensing {
namespace {

// True if an agent of the scene has this camera among its parts. Their numbers count parts first, then
// sensors.
bool has_agent_that_looks(const scene::Scene& scene, const std::string& camera) {
  const auto is_camera = [&](const auto& part) {
    return part.second >= scene.parts.size() &&
           scene.sensors.at(part.second - scene.parts.size()).name == camera;
  };
  return std::ranges::any_of(scene.agents,
                             [&](const auto& agent) { return std::ranges::any_of(agent.parts, is_camera); });
}

}  // namespace

CameraRenderer::CameraRenderer(const scene::Scene& scene, const Mount& mount,
                               const sensors::CameraSettings& settings)
    : painter_(scene, mount, settings), image_bytes_(sensors::image_bytes(settings)), image_(image_bytes_) {
  painter_.paint({}, image_);
  if (scene.clock == scene::ClockKind::kRealtime && !has_agent_that_looks(scene, settings.name))
    thread_ = std::thread([this] { work(); });
}

CameraRenderer::~CameraRenderer() {
  ending_ = true;
  ++exposures_;
  exposures_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void CameraRenderer::expose(std::span<const double> reading) {
  if (!thread_.joinable()) {
    reading_.assign(reading.begin(), reading.end());
    stale_ = true;
    return;
  }
  readings_.back().assign(reading.begin(), reading.end());
  readings_.publish();
  ++exposures_;
  exposures_.notify_one();
}

std::span<const std::byte> CameraRenderer::picture() {
  if (thread_.joinable()) {
    pictures_.refresh();
    return pictures_.front().empty() ? std::span<const std::byte>(image_) : pictures_.front();
  }
  if (stale_) painter_.paint(reading_, image_);
  stale_ = false;
  return image_;
}

void CameraRenderer::work() {
  std::uint32_t seen = 0;
  for (;;) {
    exposures_.wait(seen);
    seen = exposures_;
    if (ending_) return;
    if (!readings_.refresh()) continue;
    pictures_.back().resize(image_bytes_);
    painter_.paint(readings_.front(), pictures_.back());
    pictures_.publish();
  }
}

}  // namespace visum::sensing
