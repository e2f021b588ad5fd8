#include "clients/visum/common/parameters.h"

#include <charconv>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/link.h"
#include "protocol/config/unknown_name.h"

namespace visum::cli {
namespace {

using protocol::Parameter;
using protocol::ParameterValue;

const char* type_name(const ParameterValue& value) {
  constexpr const char* kNames[] = {"number", "integer", "flag", "text"};
  return kNames[value.index()];
}

bool is_ranged(const Parameter& parameter) {
  return parameter.value.index() < 2 && parameter.minimum < parameter.maximum;
}

std::string allowed(const Parameter& parameter) {
  if (!parameter.choices.empty()) {
    std::string list;
    for (const std::string& choice : parameter.choices) list += (list.empty() ? "" : " | ") + choice;
    return list;
  }
  if (is_ranged(parameter)) return readable(parameter.minimum) + " .. " + readable(parameter.maximum);
  return type_name(parameter.value);
}

template <typename T>
bool parse_whole(const std::string& text, T& number) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

}  // namespace

std::string to_text(const ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return readable(*number, 9);
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  return std::get<std::string>(value);
}

std::string parameter_table(const std::vector<Parameter>& parameters) {
  Table table;
  for (const Parameter& parameter : parameters) {
    const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
    table.row({parameter.name, to_text(parameter.value) + unit,
               parameter.read_only ? "read only" : allowed(parameter), parameter.help});
  }
  return table.text("  ");
}

void write_parameters(JsonWriter& json, const std::vector<Parameter>& parameters) {
  json.begin_array();
  for (const Parameter& parameter : parameters) {
    json.begin_object().member("name", parameter.name).member("type", type_name(parameter.value));
    json.key("value");
    std::visit([&](const auto& value) { json.value(value); }, parameter.value);
    json.member("unit", parameter.unit).member("help", parameter.help);
    if (is_ranged(parameter)) json.member("minimum", parameter.minimum).member("maximum", parameter.maximum);
    if (!parameter.choices.empty()) {
      json.key("choices").begin_array();
      for (const std::string& choice : parameter.choices) json.value(choice);
      json.end_array();
    }
    json.member("read_only", parameter.read_only).end_object();
  }
  json.end_array();
}

ParameterValue parse_value(const Parameter& parameter, const std::string& text) {
  double number = 0.0;
  std::int64_t integer = 0;
  switch (parameter.value.index()) {
    case 0:
      if (parse_whole(text, number)) return number;
      break;
    case 1:
      if (parse_whole(text, integer)) return integer;
      break;
    case 2:
      if (text == "true" || text == "1") return true;
      if (text == "false" || text == "0") return false;
      break;
    default:
      return text;
  }
  throw ExitError(kUsage,
                  "parameter '" + parameter.name + "' takes " + allowed(parameter) + ", not '" + text + "'");
}

const Parameter& find_parameter(const std::string& part, const std::vector<Parameter>& parameters,
                                const std::string& name) {
  std::vector<std::string> names;
  for (const Parameter& parameter : parameters) {
    if (parameter.name == name) return parameter;
    names.push_back(parameter.name);
  }
  throw ExitError(kUsage,
                  "part '" + part + "' has no parameter '" + name + "'" + config::did_you_mean(name, names));
}

}  // namespace visum::cli
