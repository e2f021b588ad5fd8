// The placeholders in a controller's command: {connect}, {host}, {port}, {scenario_dir}, {scene}, {bin},
// {seed}, {clock}.
// {{ and }} stand for the braces themselves.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace visum::run {

// What is wrong with a text's placeholders; nothing if all are known.
std::optional<std::string> find_fault(const std::string& text);

// `values` by name, without braces. The text must be without fault.
std::string fill_in(const std::string& text, const std::map<std::string, std::string>& values);

}  // namespace visum::run
