#include "clients/mca/module.h"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "clients/mca/group.h"
#include "clients/mca/part.h"
#include "protocol/module_messages.h"

namespace visum::mca {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t ns_since(Clock::time_point begin) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

}  // namespace

void CallTime::add(std::int64_t ns) {
  constexpr double kShare = 0.05;  // of the newest call
  const auto now = static_cast<double>(ns);
  mean_ns_ = mean_ns_ < 0.0 ? now : mean_ns_ + kShare * (now - mean_ns_);
}

Module::Module(Place place, PortNames names)
    : group_(place.group),
      name_(std::move(place.name)),
      controller_input_(VectorKind::kControllerInput, this, std::move(names.controller_inputs)),
      controller_output_(VectorKind::kControllerOutput, this, std::move(names.controller_outputs)),
      sensor_input_(VectorKind::kSensorInput, this, std::move(names.sensor_inputs)),
      sensor_output_(VectorKind::kSensorOutput, this, std::move(names.sensor_outputs)) {
  if (name_.empty() || name_.find('/') != std::string::npos)
    throw std::invalid_argument("a module's name must not be empty, and has no '/': '" + name_ + "'");
}

std::string Module::path() const {
  if (group_ == nullptr) return {};
  const std::string above = group_->path();
  return above.empty() ? name_ : above + "/" + name_;
}

Part& Module::part() const {
  const Module* top = this;
  while (top->group_ != nullptr) top = top->group_;
  return const_cast<Part&>(dynamic_cast<const Part&>(*top));
}

std::int64_t Module::LoopTime() const {
  return part().loop_time_ns();
}
std::int64_t Module::Period() const {
  return part().options().period_ns;
}
void Module::EndLoop() {
  part().end();
}
void Module::Debug(int level, const std::string& domain, const std::string& text) const {
  part().debug(*this, level, domain, text);
}

void Module::run_control() {
  const auto begin = Clock::now();
  Control();
  control_time_.add(ns_since(begin));
  controller_input_.look();
  parameters_changed_ = false;
}

void Module::run_sense() {
  const auto begin = Clock::now();
  Sense();
  sense_time_.add(ns_since(begin));
  sensor_input_.look();
}

}  // namespace visum::mca
