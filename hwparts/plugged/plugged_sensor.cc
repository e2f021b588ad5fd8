#include "hwparts/plugged/plugged_sensor.h"

#include <algorithm>
#include <cmath>

#include "protocol/plugin/node_settings.h"

namespace visum::plugged {
namespace {

class ContextOfSensor final : public plugin::SensorContext {
 public:
  explicit ContextOfSensor(const sensors::SensorContext& from)
      : from_(from),
        settings_(from.config, {"name", "kind", "body", "pose", "rate_hz", "latency_ms", "failure", "noise",
                                "noise_share", "bias", "resolution"}) {}

  const std::string& name() const override { return from_.name; }
  plugin::Settings& settings() override { return settings_; }
  std::size_t add_output(const plugin::Port& port) override { return add_port(ports, port); }
  void wants_rays() override { rays = true; }
  void refuse_others() const { settings_.refuse_others(); }

  std::vector<protocol::Port> ports;
  bool rays = false;

 private:
  const sensors::SensorContext& from_;
  plugin::NodeSettings settings_;
};

}  // namespace

PluggedSensor::PluggedSensor(const sensors::SensorContext& context, sensors::Layout layout, bool wants_rays,
                             std::unique_ptr<plugin::Sensor> node)
    : Sensor(context, std::move(layout)),
      node_(std::move(node)),
      guard_("sensor '" + context.name + "'"),
      wants_rays_(wants_rays) {}

void PluggedSensor::measure(const plugin::Truth& world) {
  if (!guard_.works()) guard_.forgive();  // it is measured again, so a client has set `Failure` back
  const bool done = guard_.run([&] {
    std::ranges::fill(truth(), 0.0);
    node_->measure(world, truth());
    if (std::ranges::any_of(truth(), [](double value) { return std::isnan(value); }))
      throw plugin::Error("has measured a value that is not a number");
  });
  if (done) return;
  std::ranges::fill(truth(), 0.0);
  set_parameter("Failure", std::string("off"));
}

std::unique_ptr<sensors::Sensor> make_sensor(const plugin::SensorKind& kind,
                                             const sensors::SensorContext& context) {
  ContextOfSensor made(context);
  auto node = plugin::make_node(kind, made, context.config);
  if (made.ports.empty()) context.config.fail(std::string(kind.name) + ": has no outputs");
  made.refuse_others();
  sensors::Layout layout{kind.name, made.ports, {fault_blackboard()}, {}};
  for (const auto& port : made.ports)
    layout.numbers.push_back(sensors::read_accuracy(context.config, port.minimum, port.maximum));
  return std::make_unique<PluggedSensor>(context, std::move(layout), made.rays, std::move(node));
}

}  // namespace visum::plugged
