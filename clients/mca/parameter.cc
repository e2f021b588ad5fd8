#include "clients/mca/parameter.h"

#include <stdexcept>

#include "clients/mca/module.h"
#include "protocol/module_board.h"
#include "protocol/part_description.h"

namespace visum::mca {
namespace {

// A longer text could not be shown.
bool is_short(const ParameterValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text == nullptr || text->size() <= protocol::ModuleBoard::kMostTextBytes;
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
  protocol::Parameter own = description();
  own.name = name_;
  ParameterValue wanted = value;
  if (std::string why = protocol::refuse_value(own, wanted); !why.empty()) return why;
  if (!is_short(wanted)) return "'" + name_ + "' is too long";
  if (value_ == wanted) return {};
  value_ = std::move(wanted);
  module_.parameters_changed_ = true;
  return {};
}

}  // namespace visum::mca
