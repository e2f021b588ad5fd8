#include "hwparts/part.h"

#include <algorithm>

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

bool write_into(std::vector<std::byte>& content, std::uint64_t offset, std::span<const std::byte> data) {
  if (offset > content.size()) return false;
  if (offset == 0) content.clear();
  if (content.size() - offset < data.size()) content.resize(offset + data.size());
  std::ranges::copy(data, content.begin() + static_cast<std::ptrdiff_t>(offset));
  return true;
}

std::optional<std::string> Part::refuse_fault(const Fault& fault) const {
  const auto target = fault_info(fault.kind).target;
  if (has(target)) return std::nullopt;
  return "'" + description().name + "' has no " + name_of(target) + " that could fail";
}

}  // namespace visum::hwparts
