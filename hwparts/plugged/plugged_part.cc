#include "hwparts/plugged/plugged_part.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hwparts/plugged/node_guard.h"
#include "protocol/plugin/node_settings.h"

namespace visum::plugged {
namespace {

class ContextOfPart final : public plugin::PartContext {
 public:
  explicit ContextOfPart(const hwparts::PartContext& from)
      : from_(from), settings_(from.config, {"name", "kind", "model", "joints"}) {
    for (const auto& joint : from.joints)
      joints_.push_back({joint.name, joint.prismatic, joint.lower, joint.upper, joint.initial_position});
  }

  const std::string& name() const override { return from_.name; }
  double tick_s() const override { return from_.tick_s; }
  plugin::Settings& settings() override { return settings_; }
  std::span<const plugin::Joint> joints() const override { return joints_; }
  std::size_t add_input(const plugin::Port& port) override { return add_port(inputs, port); }
  std::size_t add_output(const plugin::Port& port) override { return add_port(outputs, port); }
  void refuse_others() const { settings_.refuse_others(); }

  std::vector<protocol::Port> inputs, outputs;

 private:
  const hwparts::PartContext& from_;
  plugin::NodeSettings settings_;
  std::vector<plugin::Joint> joints_;
};

void check(const plugin::JointDrive& drive) {
  const bool finite = std::isfinite(drive.target_velocity) && std::isfinite(drive.compliance) &&
                      std::isfinite(drive.max_effort) && std::isfinite(drive.feedforward);
  if (!finite) throw plugin::Error("drives a joint by what is no finite number");
  if (drive.compliance < 0.0 || drive.max_effort < 0.0)
    throw plugin::Error("drives a joint by a negative compliance or effort");
}

class PluggedPart final : public hwparts::Part {
 public:
  PluggedPart(const hwparts::PartContext& from, const char* kind, const ContextOfPart& made,
              std::unique_ptr<plugin::Part> node)
      : node_(std::move(node)),
        guard_("part '" + from.name + "'"),
        joints_(from.joints.size()),
        samples_(from.joints.size()),
        drives_(from.joints.size()),
        outputs_(made.outputs.size()) {
    std::iota(joints_.begin(), joints_.end(), std::size_t{0});
    description_ = {from.name, kind, made.inputs, made.outputs, {}, {fault_blackboard()}};
    description_.sensor_outputs.push_back(state_port());
    start_outputs();
  }

  const protocol::PartDescription& description() const override { return description_; }
  std::span<const std::size_t> joints() const override { return joints_; }
  std::optional<std::string> refuse(std::span<const double>) const override { return {}; }

  void act(std::span<const double> inputs, std::span<const hwparts::JointSample> samples,
           std::span<hwparts::JointDrive> drives) override {
    take(samples);
    std::ranges::fill(drives_, plugin::JointDrive{});
    const bool done = guard_.run([&] {
      node_->act(inputs, samples_, drives_);
      std::ranges::for_each(drives_, check);
    });
    for (std::size_t i = 0; i < drives.size(); ++i) {
      const auto& drive = drives_[i];
      drives[i] = done ? hwparts::JointDrive{drive.target_velocity, drive.compliance, drive.max_effort,
                                             drive.feedforward}
                       : hwparts::JointDrive{};
    }
  }

  void publish(std::span<const hwparts::JointSample> samples, std::span<double> sensor_outputs) override {
    take(samples);
    std::ranges::copy(sensor_outputs.first(outputs_.size()), outputs_.begin());
    const bool done = guard_.run([&] {
      node_->publish(samples_, outputs_);
      check_values(description_.sensor_outputs, outputs_);
    });
    if (done) std::ranges::copy(outputs_, sensor_outputs.begin());
    sensor_outputs.back() = guard_.works() ? 0.0 : 1.0;
  }

  void following_errors(std::span<double> errors) const override { std::ranges::fill(errors, 0.0); }
  void controller_lost() override {
    guard_.run([&] { node_->controller_lost(); });
  }
  void reset() override {
    start_outputs();
    guard_.reset(*node_);
  }
  std::span<const std::byte> read_blackboard(std::size_t) const override { return guard_.blackboard(); }
  const std::string* node_fault() const override { return &guard_.fault(); }
  void save(hwparts::StateWriter& to) const override { guard_.save(*node_, to); }
  void load(hwparts::StateReader& from) override { guard_.load(*node_, from); }

 private:
  void take(std::span<const hwparts::JointSample> samples) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples_[i] = {samples[i].position, samples[i].velocity, samples[i].effort};
  }
  void start_outputs() {
    for (std::size_t i = 0; i < outputs_.size(); ++i) outputs_[i] = description_.sensor_outputs[i].initial;
  }

  std::unique_ptr<plugin::Part> node_;
  NodeGuard guard_;
  std::vector<std::size_t> joints_;
  std::vector<plugin::JointSample> samples_;
  std::vector<plugin::JointDrive> drives_;
  std::vector<double> outputs_;  // without `Node State`
  protocol::PartDescription description_;
};

}  // namespace

std::unique_ptr<hwparts::Part> make_part(const plugin::PartKind& kind, const hwparts::PartContext& context) {
  ContextOfPart made(context);
  auto node = plugin::make_node(kind, made, context.config);
  made.refuse_others();
  return std::make_unique<PluggedPart>(context, kind.name, made, std::move(node));
}

}  // namespace visum::plugged
