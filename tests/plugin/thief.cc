// A plug-in with a kind whose name a built-in kind has.
#include "protocol/plugin/plugin.h"

namespace {

using namespace visum::plugin;

class Nothing final : public Sensor {
 public:
  explicit Nothing(SensorContext&) {}
  void measure(const Truth&, std::span<double>) const override {}
};
constexpr SensorKind kSensors[] = {{"imu", "not the usual one", make_sensor<Nothing>}};

}  // namespace

VISUM_PLUGIN({.name = "thief", .sensors = kSensors})
