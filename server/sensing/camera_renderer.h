// Makes a camera's pictures. Its probe owns it.
//
// With clock `realtime` it paints on a thread of its own. A slow picture comes late and skips the readings in
// between; the tick never waits for one. With the other clocks, and where an agent of the scene uses the
// camera, it paints on the tick's thread when the blackboard is read. The picture is then always that of the
// reading that is shown, with the same bits in every run, as it must be: what an agent makes of it is part of
// the world. And it costs nothing while nobody looks.
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

  // Tick's thread, both. expose() takes the reading to be painted; picture() stays valid until the next call.
  void expose(std::span<const double> reading) override;
  std::span<const std::byte> picture() override;

 private:
  void work();  // the thread's loop

  Painter painter_;
  const std::size_t image_bytes_;
  // Without a thread:
  std::vector<double> reading_;   // the one that is shown
  std::vector<std::byte> image_;  // its picture, unless stale; with a thread: shown before the first picture
  bool stale_ = true;

  // With a thread:
  world::Exchange<std::vector<double>> readings_;     // to the thread
  world::Exchange<std::vector<std::byte>> pictures_;  // from the thread
  std::atomic<std::uint32_t> exposures_{0};           // counts readings; a change wakes the thread
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace visum::sensing
