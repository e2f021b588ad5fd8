// Files that compute: "${...}" in a value, and list entries that stand for many. What comes out is a plain
// tree in which every value still knows the line that it came from.
//
//   ${name}        the variable, whatever it is, where nothing stands beside it; else its text
//   ${2 * row}     a sum (expression.h); a whole number is written without a point
//   $${            stands for the two characters themselves
//   repeat: 5      in an entry of a list: the entry 5 times, with `index` from 0 to 4
//   repeat: {row: 2, column: 3}    6 times, the last name counting fastest
//
// Keys of maps are never computed.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "protocol/config/config.h"

namespace visum::config {

using Variables = std::map<std::string, Node>;

inline constexpr std::int64_t kMaxRepeats = 10'000;     // of one entry
inline constexpr std::size_t kMaxExpanded = 1'000'000;  // values, of all that is read together

// What may still be made, over all files that are read together.
struct ExpansionBudget {
  std::size_t values = kMaxExpanded;
};

// A copy of `node` with everything computed. Throws ConfigError: an unknown variable (and which was meant), a
// sum that is none, a repeat that is no number, too much of everything.
Node expanded(const Node& node, const Variables& variables, ExpansionBudget& budget);

// Whether `text` can name a variable; if not, why not ("is ..."), else empty.
std::string variable_name_fault(const std::string& text);

}  // namespace visum::config
