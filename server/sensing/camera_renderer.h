// Where a camera's pictures are made. In `realtime` on a thread of its own: a slow picture comes late, and
// replaces those that it was too slow for; the tick waits for none. Under the other clocks, and where an
// agent of the scene has the camera, when somebody looks at the blackboard, so that the picture there is
// always that of the reading that is shown, with the same bits in every run, and costs nothing where nobody
// looks: what an agent makes of it is part of the world.
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "server/sensing/painter.h"
#include "server/world/exchange.h"

namespace visum::sensing {

class CameraRenderer : public sensors::PictureMaker {
 public:
  CameraRenderer(const scene::Scene& scene, const Mount& mount, const sensors::CameraSettings& settings);
  ~CameraRenderer() override;
  CameraRenderer(const CameraRenderer&) = delete;
  CameraRenderer& operator=(const CameraRenderer&) = delete;

  // On the tick's thread.
  void expose(std::span<const double> reading) override;
  std::span<const std::byte> picture() override;

 private:
  void work();

  Painter painter_;
  const std::size_t image_bytes_;
  std::vector<double> reading_;   // lazily: the one that is shown
  std::vector<std::byte> image_;  // lazily: the picture of it
  bool stale_ = true;

  world::Exchange<std::vector<double>> readings_;     // to the thread
  world::Exchange<std::vector<std::byte>> pictures_;  // from it
  std::atomic<std::uint32_t> exposures_{0};           // counts; wakes the thread
  std::atomic<bool> ending_{false};
  std::thread thread_;  // realtime only, and without agents that look
};

}  // namespace visum::sensing
