#include "protocol/part_description.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/number_text.h"

namespace visum::protocol {
namespace {

constexpr double kMostBits = 9007199254740992.0;  // 2^53: beyond it a double holds no single bits
constexpr int kBits = 53;

const std::string* name_of(const std::vector<NumberName>& names, std::int64_t number) {
  const auto found =
      std::ranges::find_if(names, [&](const NumberName& name) { return name.number == number; });
  return found == names.end() ? nullptr : &found->name;
}

const char* type_of(const ParameterValue& value) {
  constexpr const char* kNames[] = {"a number", "a whole number", "true or false", "a text"};
  return kNames[value.index()];
}

std::string refuse_number(const Parameter& parameter, double number) {
  if (number >= parameter.minimum && number <= parameter.maximum) return {};
  return "'" + parameter.name + "' must be within " + config::number_text(parameter.minimum) + " and " +
         config::number_text(parameter.maximum);
}

std::string refuse_text(const Parameter& parameter, const std::string& text) {
  const auto& choices = parameter.choices;
  if (choices.empty() || std::ranges::find(choices, text) != choices.end()) return {};
  std::string list;
  for (const auto& choice : choices) list += (list.empty() ? "" : ", ") + choice;
  return "'" + parameter.name + "' must be one of: " + list;
}

}  // namespace

std::string in_words(const Port& port, double value) {
  if (!(std::abs(value) < kMostBits) || value != std::floor(value)) return "";
  const auto number = static_cast<std::int64_t>(value);
  if (const auto* name = name_of(port.values, number)) return *name;
  if (port.bits.empty() || number < 0) return "";
  std::string words;
  for (int bit = 0; bit < kBits; ++bit) {
    if ((number >> bit & 1) == 0) continue;
    const auto* name = name_of(port.bits, bit);
    words += (words.empty() ? "" : " ") + (name ? *name : "bit " + std::to_string(bit));
  }
  return words;
}

std::string value_text(const ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return config::number_text(*number);
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return std::to_string(*whole);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return std::get<std::string>(value);
}

std::string refuse_value(const Parameter& parameter, ParameterValue& value) {
  const auto* whole = std::get_if<std::int64_t>(&value);
  if (whole != nullptr && std::holds_alternative<double>(parameter.value))
    value = static_cast<double>(*whole);
  if (value.index() != parameter.value.index())
    return "'" + parameter.name + "' is " + type_of(parameter.value);
  if (const auto* number = std::get_if<double>(&value)) return refuse_number(parameter, *number);
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    return refuse_number(parameter, static_cast<double>(*integer));
  if (const auto* text = std::get_if<std::string>(&value)) return refuse_text(parameter, *text);
  return {};
}

}  // namespace visum::protocol
