// What stands in "${...}": a sum of numbers, names and a few functions. Inner header of protocol/config.
//
//   sum     = product { ("+" | "-") product }
//   product = factor { ("*" | "/" | "%") factor }
//   factor  = "-" factor | "(" sum ")" | number | name | function "(" sum { "," sum } ")"
//
// Functions: abs ceil cos floor max min round sin sqrt tan; "pi" is a name that is always known. a % b has
// the sign of b, so that rows and columns can be counted. Angles in rad.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace visum::config {

inline constexpr std::size_t kMaxExpressionBytes = 1000;

// Tells the number that a name stands for. Throws what it likes where there is none.
using LookUp = std::function<double(const std::string& name)>;

// Throws std::invalid_argument with a reason ("'x y' ..."): no such function, not a sum, no finite number.
double evaluate(std::string_view text, const LookUp& look_up);

// Whether `text` is a name: letters, digits and "_", no digit first.
bool is_variable_name(std::string_view text);
// Names that a file cannot take for its own: "pi" and the functions.
bool is_reserved_name(std::string_view text);

}  // namespace visum::config
