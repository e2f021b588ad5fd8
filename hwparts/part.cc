#include "hwparts/part.h"

#include "protocol/config/unknown_name.h"

namespace visum::hwparts {

std::optional<std::string> Part::set_parameter(const std::string& name, const protocol::ParameterValue&) {
  std::vector<std::string> known;
  for (const auto& parameter : parameters()) known.push_back(parameter.name);
  return config::unknown_name("parameter", name, known);
}

std::optional<std::string> Part::write_blackboard(std::size_t, std::uint64_t, std::span<const std::byte>) {
  return "the blackboard is read-only";
}

std::optional<std::string> Part::refuse_fault(const Fault& fault) const {
  const auto target = fault_info(fault.kind).target;
  if (has(target)) return std::nullopt;
  return "'" + description().name + "' has no " + name_of(target) + " that could fail";
}

}  // namespace visum::hwparts
