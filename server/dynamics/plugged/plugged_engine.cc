#include "server/dynamics/plugged/plugged_engine.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "protocol/plugin/foreign_call.h"
#include "protocol/plugin/node_settings.h"
#include "server/dynamics/plugged/plain_world.h"
#include "server/dynamics/step_input.h"

namespace visum::dynamics {
namespace plugged {
namespace {

// Everything that the plug-in's constructor may ask for: its settings, the tick, bodies and joints.
class Context final : public plugin::EngineContext {
 public:
  Context(const PlainWorld& world, const config::Node& entry, std::vector<std::string> resting)
      : world_(world), settings_(entry, std::move(resting)) {}

  plugin::Settings& settings() override { return settings_; }
  double tick_s() const override { return world_.tick_s; }
  std::span<const plugin::EngineBody> bodies() const override { return world_.bodies; }
  std::span<const plugin::EngineJoint> joints() const override { return world_.joints; }
  void refuse_others() const { settings_.refuse_others(); }

 private:
  const PlainWorld& world_;
  plugin::NodeSettings settings_;
};

// Wraps one engine of a plug-in. Simulation owns it; tick's thread. Exceptions and bad numbers of the plug-in
// become a failed step; the watch on calls that do not return is ForeignCall's.
class PluggedEngine final : public Engine {
 public:
  PluggedEngine(const plugin::EngineKind& kind, const world::WorldModel& model, std::int32_t engine_index,
                const config::Node& entry, std::vector<std::string> resting)
      : model_(model),
        index_(static_cast<std::size_t>(engine_index)),
        name_("engine '" + std::string(kind.name) + "'"),
        world_(model, engine_index) {
    Context context(world_, entry, std::move(resting));
    node_ = plugin::make_node(kind, context, entry);
    context.refuse_others();
  }

  StepResult step(const StepInput& input, world::WorldState& state) override {
    if (std::string fault = find_input_fault(model_, input, state); !fault.empty()) return {false, fault};
    try {
      advance(input, state);
    } catch (...) {
      last_.reset();  // its state after a failure cannot be trusted
      return {false, name_ + ": " + plugin::text_of_current_exception()};
    }
    std::string offender;
    if (is_sane(model_, state, &offender)) return {};
    last_.reset();
    return {false, name_ + ": " + offender};
  }

 private:
  void advance(const StepInput& input, world::WorldState& state) {
    std::vector<std::byte>& memory = state.engines[index_];
    const plugin::ForeignCall call(name_.c_str());
    if (last_ != memory) recall(memory);
    world_.load(input, state);
    node_->step(world_.tick(input.tick_s));
    world_.store(input, state);
    memory.clear();
    plugin::StateOut out(memory);
    node_->save(out);
    last_ = memory;
  }

  // The state is not the one that the last step left: it was reset or restored.
  void recall(const std::vector<std::byte>& memory) {
    if (memory.empty()) return node_->reset();
    plugin::StateIn in(memory);
    node_->load(in);
    if (!in.at_end()) throw plugin::Error("load: has read fewer bytes than it saved");
  }

  const world::WorldModel& model_;
  const std::size_t index_;
  const std::string name_;
  PlainWorld world_;
  std::unique_ptr<plugin::Engine> node_;
  // The bytes that the plug-in saved last; empty bytes for a new one. No value: its state cannot be trusted.
  std::optional<std::vector<std::byte>> last_{std::in_place};
};

}  // namespace
}  // namespace plugged

std::unique_ptr<Engine> make_plugged_engine(const plugin::EngineKind& kind, const world::WorldModel& model,
                                            std::int32_t engine_index, const config::Node& entry,
                                            std::vector<std::string> resting) {
  return std::make_unique<plugged::PluggedEngine>(kind, model, engine_index, entry, std::move(resting));
}

}  // namespace visum::dynamics
