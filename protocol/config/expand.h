// Expands files that compute: "${...}" in a value, and list entries that stand for many. The result is a
// plain tree in which every value still knows the line that it came from.
//
//   ${name}        the variable of any kind, if the value is nothing else; otherwise its text
//   ${2 * row}     the result of an expression (expression.h); a whole number has no decimal point
//   $${            the two characters ${
//   repeat: 5      in an entry of a list: the entry 5 times, with `index` from 0 to 4
//   repeat: {row: 2, column: 3}    6 times; the last name counts fastest
//
// Keys of maps are not expanded.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "protocol/config/config.h"

namespace visum::config {

using Variables = std::map<std::string, Node>;

inline constexpr std::int64_t kMaxRepeats = 10'000;     // of one entry
inline constexpr std::size_t kMaxExpanded = 1'000'000;  // values, over all files that are read together

// The number of values that may still be made, over all files that are read together.
struct ExpansionBudget {
  std::size_t values = kMaxExpanded;
};

// A copy of `node` with everything computed. Throws ConfigError for an unknown variable (and names the
// nearest), an expression that is wrong, a `repeat` that is no number, or too many values.
Node expanded(const Node& node, const Variables& variables, ExpansionBudget& budget);

// Says why `text` cannot name a variable ("is ..."); empty if it can.
std::string variable_name_fault(const std::string& text);

}  // namespace visum::config
