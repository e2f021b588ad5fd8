#include "hwparts/part.h"

namespace visum::hwparts {

std::optional<std::string> Part::set_parameter(const std::string& name, const protocol::ParameterValue&) {
  return "there is no parameter '" + name + "'";
}

std::optional<std::string> Part::write_blackboard(std::size_t, std::uint64_t, std::span<const std::byte>) {
  return "the blackboard is read-only";
}

}  // namespace visum::hwparts
