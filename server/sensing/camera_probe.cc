// Kind `camera`. Its truth is where all bodies are when the picture is taken; a CameraRenderer paints from
// that.
#include "server/sensing/camera_renderer.h"
#include "server/sensing/probes.h"

namespace visum::sensing {
namespace {

class CameraProbe : public Probe {
 public:
  CameraProbe(const ProbeContext& context, const sensors::CameraSettings& settings)
      : bodies_(context.scene.world.bodies.size()), renderer_(context.scene, context.mount, settings) {}

  void attach(sensors::Sensor& sensor) override {
    static_cast<sensors::Camera&>(sensor).bind_renderer(bodies_, renderer_);
  }
  void measure(const Moment& moment, std::span<double> truth) override { Painter::read(moment, truth); }

 private:
  std::size_t bodies_;
  CameraRenderer renderer_;
};

}  // namespace

std::unique_ptr<Probe> make_camera_probe(const ProbeContext& context) {
  const auto settings =
      sensors::read_camera(context.config, context.config.get("name").text(), context.scene.seed);
  return std::make_unique<CameraProbe>(context, settings);
}

}  // namespace visum::sensing
