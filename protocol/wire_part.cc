// Descriptions of parts: ports, parameters, blackboards.
#include "protocol/wire.h"
#include "visum.pb.h"

namespace visum::protocol::wire {
namespace {

template <typename Field>
void put(const std::vector<NumberName>& from, Field& to) {
  for (const NumberName& name : from) {
    auto& added = *to.Add();
    added.set_number(name.number);
    added.set_name(name.name);
  }
}

template <typename Field>
std::vector<NumberName> names_of(const Field& from) {
  std::vector<NumberName> names;
  for (const auto& name : from) names.push_back({name.number(), name.name()});
  return names;
}

void put(const Port& from, v1::PortDescription& to) {
  to.set_name(from.name);
  to.set_unit(from.unit);
  to.set_minimum(from.minimum);
  to.set_maximum(from.maximum);
  to.set_initial(from.initial);
  to.set_group(from.group);
  put(from.values, *to.mutable_values());
  put(from.bits, *to.mutable_bits());
}

Port port_of(const v1::PortDescription& from) {
  return {from.name(),    from.unit(),  from.minimum(),          from.maximum(),
          from.initial(), from.group(), names_of(from.values()), names_of(from.bits())};
}

template <typename Field>
bool take_parameters(const Field& from, std::vector<Parameter>& to, std::string& why) {
  to.resize(from.size());
  for (int i = 0; i < from.size(); ++i)
    if (!wire::take(from[i], to[i], why)) return false;
  return true;
}

}  // namespace

void put(const ParameterValue& from, v1::ParameterValue& to) {
  if (const auto* number = std::get_if<double>(&from)) to.set_number(*number);
  if (const auto* integer = std::get_if<std::int64_t>(&from)) to.set_integer(*integer);
  if (const auto* flag = std::get_if<bool>(&from)) to.set_flag(*flag);
  if (const auto* text = std::get_if<std::string>(&from)) to.set_text(*text);
}

bool take(const v1::ParameterValue& from, ParameterValue& to, std::string& why) {
  switch (from.value_case()) {
    case v1::ParameterValue::kNumber:
      to = from.number();
      return true;
    case v1::ParameterValue::kInteger:
      to.emplace<std::int64_t>(from.integer());
      return true;
    case v1::ParameterValue::kFlag:
      to = from.flag();
      return true;
    case v1::ParameterValue::kText:
      to = from.text();
      return true;
    case v1::ParameterValue::VALUE_NOT_SET:
      break;
  }
  why = "a parameter without a value";
  return false;
}

void put(const Parameter& from, v1::ParameterDescription& to) {
  to.set_name(from.name);
  to.set_unit(from.unit);
  to.set_help(from.help);
  put(from.value, *to.mutable_value());
  to.set_minimum(from.minimum);
  to.set_maximum(from.maximum);
  to.mutable_choices()->Add(from.choices.begin(), from.choices.end());
  to.set_read_only(from.read_only);
}

bool take(const v1::ParameterDescription& from, Parameter& to, std::string& why) {
  to.name = from.name();
  to.unit = from.unit();
  to.help = from.help();
  to.minimum = from.minimum();
  to.maximum = from.maximum();
  to.choices.assign(from.choices().begin(), from.choices().end());
  to.read_only = from.read_only();
  return take(from.value(), to.value, why);
}

void put(const Blackboard& from, v1::BlackboardDescription& to) {
  to.set_name(from.name);
  to.set_content_type(from.content_type);
  to.set_element_size(from.element_size);
  to.set_elements(from.elements);
  to.set_capacity(from.capacity);
  to.set_writable(from.writable);
}

Blackboard blackboard_of(const v1::BlackboardDescription& from) {
  return {from.name(),     from.content_type(), from.element_size(),
          from.elements(), from.capacity(),     from.writable()};
}

void put(const PartDescriptionReply& from, v1::PartDescription& to) {
  const PartDescription& part = from.description;
  to.set_name(part.name);
  to.set_kind(part.kind);
  to.set_lease_owner(from.lease_owner);
  for (const Port& port : part.controller_inputs) put(port, *to.add_controller_inputs());
  for (const Port& port : part.sensor_outputs) put(port, *to.add_sensor_outputs());
  for (const Parameter& parameter : part.parameters) put(parameter, *to.add_parameters());
  for (const Blackboard& blackboard : part.blackboards) put(blackboard, *to.add_blackboards());
}

bool take(const v1::PartDescription& from, PartDescriptionReply& to, std::string& why) {
  PartDescription& part = to.description;
  part.name = from.name();
  part.kind = from.kind();
  to.lease_owner = from.lease_owner();
  for (const auto& port : from.controller_inputs()) part.controller_inputs.push_back(port_of(port));
  for (const auto& port : from.sensor_outputs()) part.sensor_outputs.push_back(port_of(port));
  for (const auto& blackboard : from.blackboards()) part.blackboards.push_back(blackboard_of(blackboard));
  return take_parameters(from.parameters(), part.parameters, why);
}

void put(const ParameterList& from, v1::ParameterList& to) {
  for (const Parameter& parameter : from.parameters) put(parameter, *to.add_parameters());
}

bool take(const v1::ParameterList& from, ParameterList& to, std::string& why) {
  return take_parameters(from.parameters(), to.parameters, why);
}

}  // namespace visum::protocol::wire
