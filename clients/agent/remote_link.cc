#include "clients/agent/remote_link.h"

#include "protocol/plugin/port_search.h"

namespace visum::agent {

RemoteLink::RemoteLink(Client& client, const std::string& part, bool commanded)
    : part_(client.part(part)),
      inputs_(part_.all_inputs()),
      outputs_(part_.all_outputs()),
      commanded_(commanded) {
  if (commanded) part_.acquire();
}

void RemoteLink::end_turn() {
  if (!changed_) return;
  part_.write();
  changed_ = false;
}

void RemoteLink::release() {
  if (commanded_) part_.release();
}

std::size_t RemoteLink::input(std::string_view name) const {
  return plugin::index_of(part_.input_ports(), name, part_.name(), "input");
}

std::size_t RemoteLink::output(std::string_view name) const {
  return plugin::index_of(part_.output_ports(), name, part_.name(), "output");
}

plugin::Port RemoteLink::input_port(std::size_t input) const {
  return plugin::plain_port(plugin::port_at(part_.input_ports(), input, part_.name(), "input"));
}

plugin::Port RemoteLink::output_port(std::size_t output) const {
  return plugin::plain_port(plugin::port_at(part_.output_ports(), output, part_.name(), "output"));
}

double RemoteLink::value(std::size_t output) const {
  plugin::port_at(part_.output_ports(), output, part_.name(), "output");
  return outputs_.value(output);
}

double RemoteLink::command(std::size_t input) const {
  plugin::port_at(part_.input_ports(), input, part_.name(), "input");
  return inputs_.value(input);
}

void RemoteLink::set(std::size_t input, double value) {
  if (!commanded_) throw plugin::Error("part '" + part_.name() + "' is watched, not commanded");
  plugin::check_value(plugin::port_at(part_.input_ports(), input, part_.name(), "input"), value,
                      part_.name());
  inputs_.set(input, value);
  changed_ = true;
}

std::span<const std::byte> RemoteLink::blackboard(std::string_view name) {
  blackboard_ = part_.read_blackboard(std::string(name));
  return blackboard_;
}

}  // namespace visum::agent
