#include "clients/mca/vector.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "protocol/config/unknown_name.h"
#include "protocol/module_messages.h"

namespace visum::mca {

std::size_t Vector::index_of(const std::string& name) const {
  const auto found = std::ranges::find(names_, name);
  if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
  throw std::invalid_argument(
      config::unknown_name(std::string(protocol::to_string(kind_)) + " port", name, names_));
}

// Bit by bit, so that a NaN that stays is no change.
bool Vector::differs(std::size_t index) const {
  return std::memcmp(&values_.at(index), &seen_[index], sizeof(double)) != 0;
}

bool Vector::changed() const {
  if (values_.empty()) return false;
  for (std::size_t i = 0; i < values_.size(); ++i)
    if (changed(i)) return true;
  return false;
}

void Vector::look() {
  seen_ = values_;
  looked_ = true;
}

void Vector::keep_held() {
  for (const auto& [index, value] : held_) values_[index] = value;
}

void Edge::carry() const {
  for (std::size_t i = 0; i < count; ++i) to->at(first_to + i) = from->at(first_from + i);
}

}  // namespace visum::mca
