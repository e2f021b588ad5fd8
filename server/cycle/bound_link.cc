#include "server/cycle/bound_link.h"

#include <cmath>

#include "protocol/plugin/port_search.h"

namespace visum::cycle {

void BoundLink::begin_turn() {
  inputs_.assign(part().controller_inputs.begin(), part().controller_inputs.end());
  if (!part().network.ideal())
    part().network.writes().pour_into(inputs_);  // the agent's last words, arrived or not
  changed_ = false;
}

void BoundLink::end_turn(std::int64_t tick) {
  if (!changed_) return;
  if (const auto reason = part().part->refuse(inputs_))
    throw plugin::Error("part '" + description().name + "' refuses its inputs: " + *reason);
  part().hear(tick, 0, inputs_);
}

void BoundLink::lose_controller() {
  part().part->controller_lost();
  part().network.writes().clear();  // the agent's writes that are under way count no more
}

const protocol::PartDescription& BoundLink::description() const {
  return part().part->description();
}

std::size_t BoundLink::input(std::string_view name) const {
  return plugin::index_of(description().controller_inputs, name, description().name, "input");
}

std::size_t BoundLink::output(std::string_view name) const {
  return plugin::index_of(description().sensor_outputs, name, description().name, "output");
}

plugin::Port BoundLink::input_port(std::size_t input) const {
  return plugin::plain_port(
      plugin::port_at(description().controller_inputs, input, description().name, "input"));
}

plugin::Port BoundLink::output_port(std::size_t output) const {
  return plugin::plain_port(
      plugin::port_at(description().sensor_outputs, output, description().name, "output"));
}

double BoundLink::value(std::size_t output) const {
  plugin::port_at(description().sensor_outputs, output, description().name, "output");
  return part().sensor_outputs[output];
}

double BoundLink::command(std::size_t input) const {
  plugin::port_at(description().controller_inputs, input, description().name, "input");
  return inputs_.empty() ? description().controller_inputs[input].initial : inputs_[input];
}

void BoundLink::set(std::size_t input, double value) {
  if (!commanded_) throw plugin::Error("part '" + description().name + "' is watched, not commanded");
  const auto& port = plugin::port_at(description().controller_inputs, input, description().name, "input");
  plugin::check_value(port, value, description().name);
  if (inputs_.empty()) throw plugin::Error("nothing can be set before the first turn");
  inputs_[input] = value;
  changed_ = true;
}

std::span<const std::byte> BoundLink::blackboard(std::string_view name) {
  return part().part->read_blackboard(
      plugin::index_of(description().blackboards, name, description().name, "blackboard"));
}

}  // namespace visum::cycle
