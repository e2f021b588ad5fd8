#include "clients/mca/parameter.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "clients/mca/module.h"
#include "protocol/config/number_text.h"
#include "protocol/part_description.h"

namespace visum::mca {
namespace {

double number_of(const ParameterValue& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  return std::get<double>(value);
}

bool is_number(const ParameterValue& value) {
  return std::holds_alternative<double>(value) || std::holds_alternative<std::int64_t>(value);
}

const char* type_of(const ParameterValue& value) {
  constexpr const char* kNames[] = {"a number", "a whole number", "true or false", "a text"};
  return kNames[value.index()];
}

}  // namespace

ParameterBase::ParameterBase(Module& module, std::string name, ParameterValue initial,
                             ParameterOptions options)
    : module_(module), name_(std::move(name)), value_(std::move(initial)), options_(std::move(options)) {
  for (const ParameterBase* other : module_.parameters_)
    if (other->name() == name_)
      throw std::invalid_argument("'" + module_.path() + "' has two parameters '" + name_ + "'");
  module_.parameters_.push_back(this);
}

protocol::Parameter ParameterBase::description() const {
  const std::string path = module_.path();
  return {path.empty() ? name_ : path + " " + name_,
          options_.unit,
          options_.help,
          value_,
          options_.minimum,
          options_.maximum,
          options_.choices,
          false};
}

std::string ParameterBase::set(const ParameterValue& value) {
  ParameterValue wanted = value;
  if (std::holds_alternative<double>(value_) && std::holds_alternative<std::int64_t>(value))
    wanted = number_of(value);
  if (wanted.index() != value_.index()) return "'" + name_ + "' is " + type_of(value_);
  if (is_number(wanted)) {
    const double number = number_of(wanted);
    if (!(number >= options_.minimum && number <= options_.maximum))
      return "'" + name_ + "' must be within " + config::number_text(options_.minimum) + " and " +
             config::number_text(options_.maximum);
  }
  const auto* text = std::get_if<std::string>(&wanted);
  const auto& choices = options_.choices;
  if (text != nullptr && !choices.empty() && std::ranges::find(choices, *text) == choices.end()) {
    std::string list;
    for (const auto& choice : choices) list += (list.empty() ? "" : ", ") + choice;
    return "'" + name_ + "' must be one of: " + list;
  }
  if (value_ == wanted) return {};
  value_ = std::move(wanted);
  module_.parameters_changed_ = true;
  return {};
}

}  // namespace visum::mca
