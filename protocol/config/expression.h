// Evaluates the expression in "${...}": a sum of numbers, names and a few functions. Inner header of
// protocol/config.
//
//   sum     = product { ("+" | "-") product }
//   product = factor { ("*" | "/" | "%") factor }
//   factor  = "-" factor | "(" sum ")" | number | name | function "(" sum { "," sum } ")"
//
// Functions: abs ceil cos floor max min round sin sqrt tan. "pi" is a name that is always known. a % b has
// the sign of b, so that rows and columns can be counted with it. Angles in rad.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace visum::config {

inline constexpr std::size_t kMaxExpressionBytes = 1000;

// Returns the number that a name stands for. It may throw anything if there is none.
using LookUp = std::function<double(const std::string& name)>;

// The value of an expression. Throws std::invalid_argument with the reason ("'x y' ..."): unknown function,
// wrong syntax, or no finite value.
double evaluate(std::string_view text, const LookUp& look_up);

// True if `text` is a name: letters, digits and "_", not beginning with a digit.
bool is_variable_name(std::string_view text);
// True for names that a file cannot define: "pi" and the functions.
bool is_reserved_name(std::string_view text);

}  // namespace visum::config
