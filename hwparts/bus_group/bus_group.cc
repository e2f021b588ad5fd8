#include "hwparts/bus_group/bus_group.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "hwparts/drive/state_word.h"
#include "hwparts/servo_group/identity.h"
#include "hwparts/servo_group/servo_group.h"

namespace visum::bus_group {
namespace {

namespace bit = drive::state_bit;
using servo_group::OnControllerLost;
using servo_group::PartState;

constexpr std::int64_t kAskLost_ns = 200'000'000;  // how often a lost module is asked whether it is there
constexpr std::int64_t kServeWatchdog_ns = 40'000'000;  // the period of KTH's driver
constexpr std::int64_t kStandDown_ns = 1'000'000'000;

bool changes(double& seen, double now) {
  return std::exchange(seen, now) != now;
}

std::string identity_of(const std::string& kind, const servo_group::DriveList& drives,
                        const std::vector<Found>& found) {
  std::string text = servo_group::identity_text(kind, drives);
  for (std::size_t i = 0; i < found.size(); ++i) {
    char firmware[8];
    std::snprintf(firmware, sizeof firmware, "0x%04x", static_cast<unsigned>(found[i].firmware));
    text += "found module " + std::to_string(drives.drives[i].data.module) + ": firmware " + firmware +
            ", serial number " + std::to_string(found[i].serial_number) + "\n";
  }
  return text;
}

}  // namespace

BusGroup::BusGroup(const hwparts::PartContext& context, const std::string& kind,
                   const servo_group::DriveList& drives, const std::vector<Found>& found,
                   const hwparts::RealOptions& options, servo_group::PortLayout layout,
                   powercube::BusConnection& line)
    : tick_s_(context.tick_s),
      layout_(std::move(layout)),
      asker_(line, {options.answer_ns, options.tries}),
      watchdog_(options.watchdog),
      enabled_(options.execution_enable),
      on_controller_lost_(servo_group::read_options(context.config).on_controller_lost),
      identity_(identity_of(kind, drives, found)) {
  std::size_t first = 0;
  for (std::size_t i = 0; i < drives.drives.size(); ++i) {
    const auto count = drives.drives[i].joints.size();
    const auto& data = drives.drives[i].data;
    axes_.push_back({BusAxis(data, found[i]), {first, count}, drive::initial_tuning(data)});
    first += count;
  }
  std::vector<double> initial;
  for (const auto& port : layout_.controller_inputs) initial.push_back(port.initial);
  hold_all(initial);
  description_ = {context.name,           kind,         layout_.controller_inputs,
                  layout_.sensor_outputs, parameters(), {servo_group::identity_board(identity_)}};
}

std::optional<std::string> BusGroup::refuse(std::span<const double> inputs) const {
  if (auto reason = refuse_counters(layout_, inputs)) return reason;
  for (const auto& axis : axes_) {
    const double tolerance = axis.module.data().increment();
    if (auto reason = refuse_unequal(layout_, axis.run, tolerance, inputs)) return reason;
  }
  return std::nullopt;
}

void BusGroup::act(std::span<const double> inputs, std::span<const hwparts::JointSample>,
                   std::span<hwparts::JointDrive>) {
  pump();
  enabled_ = inputs[layout_.enable] >= 0.5;
  apply_counters(inputs);
  // Desired values that are written while anything is stopped do not count.
  if (!settling() && (controller_lost_ || any(bit::kError | bit::kHalted))) hold_all(inputs);
  const auto given = leave();
  for (auto& axis : axes_) drive(axis, inputs, given);
  pump();
  ++changed_;
}

void BusGroup::apply_counters(std::span<const double> inputs) {
  if (changes(reset_, inputs[layout_.reset])) {
    if (controller_lost_ || any(bit::kError | bit::kHalted)) hold_all(inputs);
    controller_lost_ = false;
    for (auto& axis : axes_) axis.module.reset();
  }
  const bool may_home = enabled_ && !controller_lost_ && !any(bit::kError);
  if (changes(home_, inputs[layout_.home]) && may_home) {
    hold_all(inputs);
    for (auto& axis : axes_) axis.module.home();
  }
  if (changes(halt_, inputs[layout_.halt])) {
    hold_all(inputs);
    for (auto& axis : axes_) axis.module.halt();
  }
}

void BusGroup::hold_all(std::span<const double> inputs) {
  for (auto& axis : axes_) {
    axis.ignored = desired_value(layout_, axis.run, inputs);
    axis.held = true;
  }
}

// kWait while a module settles: a Reset without a fault settles too, and must not disturb a motion.
BusGroup::Leave BusGroup::leave() const {
  if (!enabled_ || controller_lost_ || any(bit::kError | bit::kHalted)) return Leave::kStand;
  const auto busy = [](const Axis& axis) { return axis.module.settling() || axis.module.homing(); };
  return std::ranges::any_of(axes_, busy) ? Leave::kWait : Leave::kMove;
}

void BusGroup::drive(Axis& axis, std::span<const double> inputs, Leave leave) {
  const double desired = desired_value(layout_, axis.run, inputs);
  if (axis.held && desired != axis.ignored) axis.held = false;
  // A homing module takes no other motion: only HALT stops it.
  if (axis.module.homing()) {
    if (!enabled_ || any(bit::kError)) axis.module.halt();
    return;
  }
  if (leave == Leave::kStand || !axis.module.has(bit::kHomeOk)) return axis.module.stand();
  if (leave == Leave::kMove && !axis.held)
    axis.module.follow(desired, maximum_speed(layout_, axis.run, inputs));
}

void BusGroup::publish(std::span<const hwparts::JointSample>, std::span<double> outputs) {
  for (const auto& axis : axes_) {
    const auto& reading = axis.module.reading();
    const double n = static_cast<double>(axis.run.count);
    const auto lost = controller_lost_ ? bit::kError | bit::kCommError : 0U;
    for (std::size_t i = axis.run.first; i < axis.run.first + axis.run.count; ++i) {
      const auto& channel = layout_.channels[i];
      outputs[channel.actual] = reading.position / n;
      outputs[channel.speed] = reading.speed / n;
      outputs[channel.current] = reading.current;
      outputs[channel.state] = axis.module.state_word() | lost;
    }
  }
  outputs[layout_.part_state] = static_cast<double>(part_state());
  outputs[layout_.changed] = static_cast<double>(changed_);
}

bool BusGroup::any(std::uint32_t bits) const {
  return std::ranges::any_of(axes_, [bits](const Axis& axis) { return axis.module.has(bits); });
}

bool BusGroup::settling() const {
  return std::ranges::any_of(axes_, [](const Axis& axis) { return axis.module.settling(); });
}

PartState BusGroup::part_state() const {
  const auto homing = [](const Axis& axis) { return axis.module.homing(); };
  const auto homed = [](const Axis& axis) { return axis.module.has(bit::kHomeOk); };
  if (controller_lost_) return PartState::kControllerLost;
  if (any(bit::kError)) return PartState::kFault;
  if (any(bit::kHalted)) return PartState::kHalted;
  if (std::ranges::any_of(axes_, homing)) return PartState::kHoming;
  if (!std::ranges::all_of(axes_, homed)) return PartState::kNotHomed;
  if (!enabled_) return PartState::kDisabled;
  const auto moves = [](const Axis& axis) { return axis.module.moves(); };
  return std::ranges::any_of(axes_, moves) ? PartState::kMoving : PartState::kReady;
}

void BusGroup::controller_lost() {
  if (on_controller_lost_ == OnControllerLost::kHold) return;
  controller_lost_ = true;
  for (auto& axis : axes_) axis.module.halt();
  pump();
}

std::vector<protocol::Parameter> BusGroup::parameters() const {
  std::vector<protocol::Parameter> all{servo_group::lost_parameter(on_controller_lost_)};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto& data = axes_[i].module.data();
    for (const auto& field : servo_group::tuning_fields()) {
      if (field.module_parameter == 0 || (field.limit && !data.limits.limited)) continue;
      all.push_back(servo_group::field_parameter(field, data, axes_[i].tuning, i + 1, tick_s_));
    }
  }
  return all;
}

std::optional<std::string> BusGroup::set_parameter(const std::string& name,
                                                   const protocol::ParameterValue& value) {
  if (name == servo_group::kOnControllerLost) return servo_group::set_lost(value, on_controller_lost_);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    for (const auto& field : servo_group::tuning_fields())
      if (field.module_parameter != 0 && name == field.name + (" " + std::to_string(i + 1)))
        return set_tuning(axes_[i], field, servo_group::as_number(value));
  }
  return Part::set_parameter(name, value);
}

std::optional<std::string> BusGroup::set_tuning(Axis& axis, const servo_group::TuningField& field,
                                                double value) {
  if (!std::isfinite(value)) return "must be a finite number";
  const double position = axis.module.reading().position;
  if (auto reason = change(field, axis.module.data(), position, value, tick_s_, axis.tuning)) return reason;
  axis.module.set(field.module_parameter, value);
  return std::nullopt;
}

std::span<const std::byte> BusGroup::read_blackboard(std::size_t index) const {
  if (index != 0) return {};
  return std::as_bytes(std::span(identity_));
}

// Takes the answers, then sends as many requests as the bus takes: first the wishes of all modules, then
// readings.
void BusGroup::pump() {
  while (const auto outcome = asker_.next()) {
    for (auto& axis : axes_)
      if (axis.module.module() == outcome->module) axis.module.take(outcome->request, outcome->answer);
  }
  if (!asker_.line().up()) return lose_all();
  serve_watchdog();
  while (ask_one(true)) {
  }
  while (ask_one(false)) {
  }
}

void BusGroup::lose_all() {
  asker_.forget();
  for (auto& axis : axes_) axis.module.lose();
}

bool BusGroup::ask_one(bool wishes_only) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    auto& axis = axes_[(turn_ + i) % axes_.size()];
    const bool late = asker_.line().now_ns() - axis.asked_ns >= kAskLost_ns;
    const bool wanted = axis.module.has_wish() || (!wishes_only && (!axis.module.lost() || late));
    if (!wanted || !asker_.may_ask(axis.module.module())) continue;
    turn_ = (turn_ + i + 1) % axes_.size();
    ask(axis);
    return true;
  }
  return false;
}

void BusGroup::ask(Axis& axis) {
  const bool lost = axis.module.lost();
  if (lost) axis.asked_ns = asker_.line().now_ns();
  const powercube::Patience once{asker_.patience().answer_ns, 1};
  asker_.ask(axis.module.module(), axis.module.next_request(), lost ? once : asker_.patience());
}

void BusGroup::serve_watchdog() {
  const auto now = asker_.line().now_ns();
  if (!watchdog_ || now - served_ns_ < kServeWatchdog_ns) return;
  served_ns_ = now;
  asker_.tell_all({powercube::command::kWatchdog, 0});
}

// A process that ends must leave nothing moving behind.
void BusGroup::stand_down() {
  const auto moves = [](const Axis& axis) { return axis.module.moves(); };
  if (std::ranges::none_of(axes_, moves)) return;
  for (auto& axis : axes_) axis.module.halt();
  const auto until = asker_.line().now_ns() + kStandDown_ns;
  while (settling() && asker_.line().now_ns() < until) {
    pump();
    asker_.line().wait_until(std::min(until, asker_.next_due_ns()));
  }
}

namespace {

void refuse_speed_control(const hwparts::PartContext& planned, const servo_group::DriveList& drives) {
  for (const auto& entry : drives.drives)
    if (entry.data.speed_controlled)
      planned.config.get("drives").fail("'control: velocity' is for simulated drives only");
}

}  // namespace

std::unique_ptr<hwparts::Part> make(const Kind& kind, const hwparts::PartContext& planned,
                                    powercube::BusConnection& line, const hwparts::RealOptions& options) {
  servo_group::read_options(planned.config);
  auto drives = servo_group::load_drives(planned);
  refuse_speed_control(planned, drives);
  kind.check(planned, drives);
  std::vector<Expected> expected;
  for (const auto& entry : drives.drives)
    expected.push_back({entry.data, powercube::stated_serial_number(planned.config, entry.data.module)});
  powercube::Asker asker(line, {options.answer_ns, options.tries});
  const auto found = survey(asker, expected, options.watchdog);
  auto context = planned;
  bool homed = true;
  for (std::size_t i = 0; i < found.size(); ++i) {
    auto& entry = drives.drives[i];
    entry.initial_position = found[i].position;
    for (const auto joint : entry.joints)
      context.joints[joint].initial_position = found[i].position / static_cast<double>(entry.joints.size());
    homed = homed && (found[i].state & bit::kHomeOk) != 0;
  }
  auto layout =
      servo_group::make_layout(kind.blocks(drives), drives, context, {homed, options.execution_enable});
  return std::make_unique<BusGroup>(context, kind.name, drives, found, options, std::move(layout), line);
}

std::unique_ptr<hwparts::Part> make_servo_group(const hwparts::PartContext& context,
                                                powercube::BusConnection& line,
                                                const hwparts::RealOptions& options) {
  static constexpr Kind kKind{"servo_group",
                              [](const hwparts::PartContext&, const servo_group::DriveList&) {},
                              servo_group::one_block};
  return make(kKind, context, line, options);
}

}  // namespace visum::bus_group
