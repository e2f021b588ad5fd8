// Inputs and Outputs: views of a part's ports.
#include <cmath>
#include <sstream>

#include "clients/cpp/client_state.h"

namespace visum {
namespace {

[[noreturn]] void fail_index(const detail::PartState& part, std::size_t i, std::size_t size) {
  throw Error(ErrorCode::kMisuse,
              "there is no index " + std::to_string(i) + " in a group of " + std::to_string(size) + " ports",
              part.name);
}

void check_value(const detail::PartState& part, const PortInfo& port, double value) {
  if (std::isfinite(value) && value >= port.minimum && value <= port.maximum) return;
  std::ostringstream text;
  text << part.name << ": " << port.name << ": " << value << " is not in " << port.minimum << " .. "
       << port.maximum;
  if (!port.unit.empty()) text << ' ' << port.unit;
  throw Error(ErrorCode::kBadValue, text.str(), part.name, port.name);
}

}  // namespace

const PortInfo& Inputs::info(std::size_t i) const {
  if (i >= ports_.size()) fail_index(*part_, i, ports_.size());
  return part_->input_ports[ports_[i]];
}

double Inputs::value(std::size_t i) const {
  return part_->inputs[info(i).index];
}

void Inputs::check(std::size_t i, double value) const {
  check_value(*part_, info(i), value);
}

void Inputs::set(double value) {
  set(std::span<const double>(&value, 1));
}

void Inputs::set(std::size_t i, double value) {
  const PortInfo& port = info(i);
  check_value(*part_, port, value);
  part_->inputs[port.index] = value;
  part_->set[port.index] = part_->staged[port.index] = true;
}

void Inputs::set(std::span<const double> values) {
  if (values.size() != ports_.size()) {
    throw Error(
        ErrorCode::kMisuse,
        std::to_string(values.size()) + " values were given for " + std::to_string(ports_.size()) + " ports",
        part_->name);
  }
  for (std::size_t i = 0; i < values.size(); ++i) check_value(*part_, info(i), values[i]);
  for (std::size_t i = 0; i < values.size(); ++i) set(i, values[i]);
}

void Inputs::set(std::initializer_list<double> values) {
  set(std::span(values.begin(), values.size()));
}

const PortInfo& Outputs::info(std::size_t i) const {
  if (i >= ports_.size()) fail_index(*part_, i, ports_.size());
  return part_->output_ports[ports_[i]];
}

double Outputs::value(std::size_t i) const {
  return part_->outputs[info(i).index];
}

std::vector<double> Outputs::values() const {
  std::vector<double> values;
  values.reserve(size());
  for (const std::size_t port : ports_) values.push_back(part_->outputs[port]);
  return values;
}

}  // namespace visum
