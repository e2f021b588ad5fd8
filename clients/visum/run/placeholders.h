// The placeholders in a controller's command: {connect}, {host}, {port}, {scenario_dir}, {scene}, {bin},
// {seed}, {clock}, and {bus.PART} for each of the scenario's buses.
// {{ and }} stand for the braces themselves.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace visum::run {

// Returns the mistake in a text's placeholders, or nothing if all are known.
std::optional<std::string> find_fault(const std::string& text);

// The parts whose {bus.PART} stands in a text without fault.
std::vector<std::string> parts_with_bus(const std::string& text);

// `values` by name, without braces. The text must be without fault.
std::string fill_in(const std::string& text, const std::map<std::string, std::string>& values);

}  // namespace visum::run
