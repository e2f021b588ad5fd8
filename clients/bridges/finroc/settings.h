// Parameters and blackboards as values of the board's ports. Pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "clients/bridges/finroc/board.h"
#include "protocol/part_description.h"

namespace visum::finroc {

inline Type text_type() {
  return {Kind::kText, "String", {}};
}

// The type of a parameter that has this value. `owner` makes the name of a list of choices unique.
Type setting_type(const std::string& owner, const std::string& name, const protocol::ParameterValue& value,
                  const std::vector<std::string>& choices);
Value to_board(const Type& type, const protocol::ParameterValue& value);
// A parameter's type is known by the value that its port has.
protocol::ParameterValue to_server(const Element& element, const Value& value);
double as_double(const Value& value);

// A blackboard in words: text, numbers by row, or how many bytes it has. `head` may be the beginning only.
std::string shown(const std::string& content_type, std::uint64_t row_bytes, std::span<const std::byte> head,
                  std::uint64_t total_bytes);

}  // namespace visum::finroc
