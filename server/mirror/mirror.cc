#include "server/mirror/mirror.h"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "hwparts/servo_group/part_state.h"

namespace visum::mirror {
namespace {

using protocol::kEmergencyStop;
using protocol::Port;
using servo_group::PartState;

std::optional<std::size_t> find(const std::vector<Port>& ports, const std::string& name) {
  for (std::size_t i = 0; i < ports.size(); ++i)
    if (ports[i].name == name) return i;
  return std::nullopt;
}

std::size_t need(const std::vector<Port>& ports, const std::string& name) {
  if (const auto found = find(ports, name)) return *found;
  throw std::runtime_error("the part has no port '" + name + "': it cannot be stopped when the arms diverge");
}

}  // namespace

Mirror::Mirror(const std::array<std::string, kArms>& addresses, const std::string& part, const Entry& entry)
    : arms_{ArmLink(addresses[0], part, entry), ArmLink(addresses[1], part, entry)},
      description_(arms_[0].description()) {
  check_alike();
  for (const auto& parameter : arms_[1].description().parameters)
    if (parameter.name == kEmergencyStop && !arms_[0].has_parameter(kEmergencyStop))
      description_.parameters.push_back(parameter);
  halt_ = need(description_.controller_inputs, "Halt");
  reset_ = need(description_.controller_inputs, "Reset");
  part_state_ = find(description_.sensor_outputs, "Part State");
  for (const auto& port : description_.controller_inputs) initial_.push_back(port.initial);
  inputs_ = initial_;
  for (auto& arm : arms_) arm.rebase(inputs_, initial_);
  for (std::size_t i = 0; i < description_.sensor_outputs.size(); ++i) {
    const auto& unit = description_.sensor_outputs[i].unit;
    if (unit == "rad" || unit == "m") compared_.push_back(i);
  }
  divergence_.assign(compared_.size(), 0.0);
  const auto board = arms_[0].read_blackboard("Identity");
  identity_.assign(reinterpret_cast<const char*>(board.data()), board.size());
  compare();
  find_world(entry);
}

void Mirror::find_world(const Entry& entry) {
  for (std::size_t i = 0; i < kArms && !world_of_; ++i) {
    world_.emplace(arms_[i].address(), entry);
    if (world_->has_world()) world_of_ = i;
  }
  if (!world_of_) world_.reset();
}

void Mirror::show_world(gateway::Published& published) const {
  if (world_) world_->fill(published);
}

void Mirror::check_alike() const {
  if (const auto unlike = difference(arms_[0].description(), arms_[1].description()))
    throw std::runtime_error("the two arms are not alike: " + *unlike);
}

void Mirror::pump() {
  for (auto& arm : arms_)
    if (arm.poll()) take_up(arm);
  away_.store(look_who_is_away(), std::memory_order_relaxed);
  if (world_) world_->poll();
  hear_refusals();
  compare();
}

// The arm's counters go on from where they are, so it does not carry out late what it has missed. Only a halt
// is sent again, since it stands until the controller's Reset.
void Mirror::take_up(ArmLink& arm) {
  auto before = commanded();
  if (halted_) before[halt_] -= 1.0;
  arm.rebase(before, initial_);
  if (halted_) arm.write_counters(commanded(), initial_);
}

// After a lost controller both arms were left, and are looked for; the next controller waits for both. If the
// primary is gone for longer, it would miss commands that are carried out once (counters). If both are, every
// command would be missed. An other arm that is gone for longer counts as missing nothing.
AwayArm Mirror::look_who_is_away() const {
  using enum AwayArm::Misses;
  for (std::size_t i = 0; i < kArms; ++i)
    if (arms_[i].comes_back()) return {static_cast<std::uint8_t>(i), kEverything};
  if (arms_[primary_].connected()) return {};
  const bool both_are_away = !arms_[1 - primary_].connected();
  return {static_cast<std::uint8_t>(primary_), both_are_away ? kEverything : kCounters};
}

bool Mirror::misses_something(AwayArm away, std::span<const double> before,
                              std::span<const double> inputs) const {
  if (away.misses == AwayArm::Misses::kNothing || before[halt_] != inputs[halt_]) return false;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const bool counts =
        away.misses == AwayArm::Misses::kEverything || is_counter(description_.controller_inputs[i]);
    if (counts && before[i] != inputs[i]) return true;
  }
  return false;
}

std::optional<std::string> Mirror::refuse_now(std::span<const double> before,
                                              std::span<const double> inputs) const {
  const auto away = away_.load(std::memory_order_relaxed);
  if (!misses_something(away, before, inputs)) return std::nullopt;
  return arms_[away.arm].address() + " is away, and would miss this command: try again when it is back";
}

// It is too late to refuse the command: the controller was told that it was accepted, and the other arm may
// have carried it out. So this is a fault.
void Mirror::hear_refusals() {
  for (std::size_t i = 0; i < kArms; ++i) {
    if (refusals_seen_[i] == arms_[i].refusals()) continue;
    refusals_seen_[i] = arms_[i].refusals();
    if (!fault_) raise(arms_[i].address() + " refuses a command: " + arms_[i].refusal());
  }
}

void Mirror::compare() {
  if (!arms_[0].connected() || !arms_[1].connected()) return;
  const auto shown = arms_[primary_].sensor_outputs(), other = arms_[1 - primary_].sensor_outputs();
  for (std::size_t i = 0; i < compared_.size(); ++i)
    divergence_[i] = other[compared_[i]] - shown[compared_[i]];
  const bool angle = bounds_.angle_limit_rad > 0.0 && largest("rad") > bounds_.angle_limit_rad;
  const bool position = bounds_.position_limit_m > 0.0 && largest("m") > bounds_.position_limit_m;
  const bool exceeded = angle || position;
  if (exceeded && !exceeded_)
    raise("the arms diverge by " + std::to_string(largest("rad")) + " rad and " +
          std::to_string(largest("m")) + " m");
  exceeded_ = exceeded;
}

void Mirror::raise(const std::string& why) {
  spdlog::error("{}", why);
  why_ = why;
  fault_ = true;
  halt();
}

void Mirror::halt() {
  halted_ = true;
  halts_ += 1.0;
  const auto values = commanded();
  for (auto& arm : arms_) arm.write_counters(values, initial_);
}

double Mirror::largest(const char* unit) const {
  double most = 0.0;
  for (std::size_t i = 0; i < compared_.size(); ++i)
    if (description_.sensor_outputs[compared_[i]].unit == unit)
      most = std::max(most, std::abs(divergence_[i]));
  return most;
}

void Mirror::command(std::span<const double> inputs) {
  if (std::ranges::equal(inputs, inputs_)) return;
  if (inputs[reset_] != inputs_[reset_]) {
    fault_ = halted_ = false;
    exceeded_ = false;  // if they are still too far apart, that is a new fault
  }
  if (inputs[halt_] != inputs_[halt_]) halted_ = true;
  const auto before = std::exchange(inputs_, {inputs.begin(), inputs.end()});
  send();
  const auto away = look_who_is_away();
  if (!fault_ && misses_something(away, before, inputs_))
    raise(arms_[away.arm].address() + " was away, and has missed a command");
}

std::vector<double> Mirror::commanded() const {
  auto values = inputs_;
  values[halt_] += halts_;
  return values;
}

void Mirror::send() {
  const auto values = commanded();
  for (auto& arm : arms_) arm.write(values, initial_);
}

void Mirror::controller_lost() {
  for (auto& arm : arms_) arm.drop();
  pump();
}

void Mirror::read(std::span<double> outputs) const {
  std::ranges::copy(arms_[primary_].sensor_outputs(), outputs.begin());
  if (part_state_ && (fault_ || !arms_[primary_].connected()))
    outputs[*part_state_] = static_cast<double>(PartState::kFault);
}

std::optional<std::string> Mirror::switch_to(std::size_t arm, bool by_force) {
  if (arm == primary_) return std::nullopt;
  if (!arms_[arm].connected()) return arms_[arm].address() + " is gone";
  const double angle = largest("rad"), position = largest("m");
  if (!by_force && (angle > bounds_.angle_switch_rad || position > bounds_.position_switch_m))
    return "the arms are " + std::to_string(angle) + " rad and " + std::to_string(position) +
           " m apart, more than " + std::to_string(bounds_.angle_switch_rad) + " rad and " +
           std::to_string(bounds_.position_switch_m) + " m; 'Force Primary' switches all the same";
  primary_ = arm;
  away_.store(look_who_is_away(), std::memory_order_relaxed);
  for (double& difference : divergence_) difference = -difference;
  spdlog::info("{} is the primary now", arms_[arm].address());
  return std::nullopt;
}

std::vector<protocol::Parameter> Mirror::parameters() {
  auto all = arms_[primary_].parameters();
  if (std::ranges::find(all, kEmergencyStop, &protocol::Parameter::name) != all.end()) return all;
  for (auto& parameter : arms_[1 - primary_].parameters())
    if (parameter.name == kEmergencyStop) all.push_back(std::move(parameter));
  return all;
}

std::optional<std::string> Mirror::set_parameter(const std::string& name,
                                                 const protocol::ParameterValue& value) {
  if (name == kEmergencyStop) return set_emergency_stop(value);
  for (const auto& arm : arms_)
    if (!arm.connected()) return arm.address() + " is gone, and the other arm keeps its '" + name + "', too";
  auto &primary = arms_[primary_], &shadow = arms_[1 - primary_];
  const auto before = primary.parameter(name);
  if (auto reason = primary.set_parameter(name, value)) return reason;
  const auto reason = shadow.set_parameter(name, value);
  if (!reason) return std::nullopt;
  const auto failure =
      before ? primary.set_parameter(name, *before) : std::optional("it is not known what it was");
  if (!failure) return reason;
  return *reason + "; and it was not taken back at " + primary.address() + ": " + *failure;
}

// Both arms are asked before either one answers, so that a server that hangs does not delay the other arm's
// stop.
std::optional<std::string> Mirror::set_emergency_stop(const protocol::ParameterValue& value) {
  const auto* pressed = std::get_if<bool>(&value);
  if (!pressed) return "must be true or false";
  const auto has_one = [](const ArmLink& arm) { return arm.has_parameter(kEmergencyStop); };
  const bool all_have_one = std::ranges::all_of(arms_, has_one);
  if (*pressed && !all_have_one) halt();
  for (auto& arm : arms_)
    if (has_one(arm)) arm.ask_to_set(kEmergencyStop, value);
  std::string missed;
  for (auto& arm : arms_) {
    auto reason = has_one(arm) ? arm.answer() : std::nullopt;
    if (*pressed && !arm.connected()) reason = arm.address() + " is gone, and is halted when it is back";
    if (reason) missed += (missed.empty() ? "" : "; ") + *reason;
  }
  if (missed.empty()) return std::nullopt;
  if (*pressed && all_have_one) halt();
  return (*pressed ? "the emergency stop did not reach all: " : "not released everywhere: ") + missed;
}

void Mirror::wait_until(std::chrono::steady_clock::time_point due) {
  const auto left = std::max(due - std::chrono::steady_clock::now(), std::chrono::steady_clock::duration{});
  const auto ns = std::chrono::duration_cast<std::chrono::nanoseconds>(left).count();
  const timespec wait{static_cast<time_t>(ns / 1'000'000'000), static_cast<long>(ns % 1'000'000'000)};
  std::array<pollfd, kArms + 1> set{};
  for (std::size_t i = 0; i < kArms; ++i) set[i] = {arms_[i].descriptor(), POLLIN, 0};
  set[kArms] = {world_ ? world_->descriptor() : -1, POLLIN, 0};
  ::ppoll(set.data(), set.size(), &wait, nullptr);
}

}  // namespace visum::mirror
