#include "server/cycle/agent_part.h"

#include <algorithm>
#include <limits>

#include "protocol/plugin/node_settings.h"
#include "server/cycle/bound_link.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {

// Answers an agent's questions while it is made: its settings and parts.
class AgentPart::Context final : public plugin::AgentContext {
 public:
  Context(const scene::AgentPlan& plan, std::vector<BoundPart>& parts, AgentPart& agent)
      : plan_(plan),
        parts_(parts),
        agent_(agent),
        settings_(plan.config, {"name", "kind", "period_ms", "parts"}) {}

  const std::string& name() const override { return plan_.name; }
  double period_s() const override { return static_cast<double>(plan_.period_ns) * 1e-9; }
  plugin::Settings& settings() override { return settings_; }

  plugin::PartLink& commanded(std::string_view word) override {
    const std::size_t number = number_of(word);
    std::string& owner = parts_[number].agent;
    if (!owner.empty() && owner != plan_.name)
      throw plugin::Error("part '" + parts_[number].part->description().name + "' is commanded by agent '" +
                          owner + "' already");
    owner = plan_.name;
    return link(number, true);
  }
  plugin::PartLink& watched(std::string_view word) override { return link(number_of(word), false); }

  std::size_t add_output(const plugin::Port& port) override {
    return plugged::add_port(agent_.description_.sensor_outputs, port);
  }

  // Fails where the scene gives the agent something that it did not ask for: most likely a mistake.
  void refuse_others() const {
    settings_.refuse_others();
    for (const auto& [word, number] : plan_.parts)
      if (std::ranges::find(asked_, word) == asked_.end())
        plan_.config.get("parts").get(word).fail("the agent has no use for a part '" + word + "'");
  }

 private:
  // Index of the part that the scene gives the agent under this word.
  std::size_t number_of(std::string_view word) {
    asked_.emplace_back(word);
    for (const auto& [known, number] : plan_.parts)
      if (known == word) return number;
    throw plugin::Error("needs a part as '" + asked_.back() + "' under 'parts'");
  }
  plugin::PartLink& link(std::size_t number, bool commanded) {
    agent_.links_.push_back(std::make_unique<BoundLink>(parts_, number, commanded));
    return *agent_.links_.back();
  }

  const scene::AgentPlan& plan_;
  std::vector<BoundPart>& parts_;
  AgentPart& agent_;
  plugin::NodeSettings settings_;
  std::vector<std::string> asked_;
};

AgentPart::AgentPart(const scene::AgentPlan& plan, std::int64_t tick_ns, std::vector<BoundPart>& parts)
    : tick_ns_(tick_ns), period_ns_(plan.period_ns), guard_("agent '" + plan.name + "'") {
  description_ = {plan.name, plan.kind->name, {}, {}, {}, {plugged::fault_blackboard()}};
  Context context(plan, parts, *this);
  agent_ = plugin::make_node(*plan.kind, context, plan.config);
  context.refuse_others();
  outputs_.resize(description_.sensor_outputs.size());
  description_.sensor_outputs.push_back({"Turns", "", 0.0, std::numeric_limits<double>::max(), 0.0, ""});
  description_.sensor_outputs.push_back(plugged::state_port());
  start_outputs();
}

AgentPart::~AgentPart() = default;

void AgentPart::start_outputs() {
  for (std::size_t i = 0; i < outputs_.size(); ++i) outputs_[i] = description_.sensor_outputs[i].initial;
}

bool AgentPart::due(std::int64_t now_ns) const {
  return now_ns == 0 || now_ns / period_ns_ > (now_ns - tick_ns_) / period_ns_;
}

void AgentPart::think(std::int64_t now_ns) {
  if (!guard_.works() || !due(now_ns)) return;
  const bool done = guard_.run([&] {
    for (auto& link : links_) link->begin_turn();
    agent_->think({now_ns, outputs_});
    plugged::check_values(description_.sensor_outputs, outputs_);
    for (auto& link : links_) link->end_turn(now_ns / tick_ns_);
  });
  ++turns_;
  if (!done) let_go();
}

void AgentPart::let_go() {
  for (auto& link : links_)
    if (link->commanded()) link->lose_controller();
}

void AgentPart::publish(std::span<const hwparts::JointSample>, std::span<double> sensor_outputs) {
  if (guard_.works()) std::ranges::copy(outputs_, sensor_outputs.begin());
  sensor_outputs[outputs_.size()] = static_cast<double>(turns_);
  sensor_outputs.back() = guard_.works() ? 0.0 : 1.0;
}

void AgentPart::reset() {
  turns_ = 0;
  start_outputs();
  guard_.reset(*agent_);
}

void AgentPart::save(hwparts::StateWriter& to) const {
  to.put(turns_);
  to.put(std::span<const double>(outputs_));
  guard_.save(*agent_, to);
}

void AgentPart::load(hwparts::StateReader& from) {
  from.get(turns_);
  from.get(std::span<double>(outputs_));
  guard_.load(*agent_, from);
}

}  // namespace visum::cycle
