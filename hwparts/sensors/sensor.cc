#include "hwparts/sensors/sensor.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace visum::sensors {
namespace {

constexpr const char* kFailure = "Failure";

Failure read_failure(const config::Node& entry) {
  const auto node = entry.find("failure");
  if (!node) return Failure::kOk;
  std::vector<std::string> names;
  for (const auto& row : failure_names()) names.emplace_back(row.name);
  const std::string word = node->one_of(names);
  return std::ranges::find(failure_names(), word, &FailureName::name)->failure;
}

// The number of readings that can be on their way at once: those that a failed sensor holds back longest, the
// one that is being taken, and one that waits for the end of a silence. Samples are taken and shown at the
// ends of ticks, so each may be taken up to a tick late and shown up to another tick later.
std::size_t slots(const Timing& timing) {
  const std::int64_t longest_ns = timing.latency_ns + 2 * timing.tick_ns;
  return static_cast<std::size_t>(longest_ns / timing.period_ns) + kDelayedSamples + 3;
}

protocol::Parameter fixed_number(const char* name, const char* unit, const char* help, double value) {
  protocol::Parameter parameter{name, unit, help, value, 0.0, std::numeric_limits<double>::max()};
  parameter.read_only = true;
  return parameter;
}

}  // namespace

Sensor::Sensor(const SensorContext& context, Layout layout)
    : layout_(std::move(layout)),
      name_(context.name),
      seed_(context.seed),
      timing_(read_timing(context.config, context.tick_ns)),
      initial_failure_(read_failure(context.config)),
      truth_(layout_.numbers.size()),
      offsets_(layout_.numbers.size()),
      random_(seed_, name_),
      failure_(initial_failure_),
      last_(layout_.numbers.size()),
      shown_(layout_.numbers.size()),
      queue_(slots(timing_), layout_.numbers.size()) {
  description_.name = name_;
  description_.kind = layout_.kind;
  description_.sensor_outputs = layout_.ports;
  description_.sensor_outputs.push_back({"Changed", "", 0.0, std::numeric_limits<double>::max(), 0.0, ""});
  description_.blackboards = layout_.blackboards;
  description_.parameters = Sensor::parameters();
  Sensor::reset();
}

void Sensor::set_numbers(std::vector<Accuracy> numbers) {
  const std::size_t count = numbers.size();
  layout_.numbers = std::move(numbers);
  for (auto* values : {&truth_, &offsets_, &last_, &shown_}) values->assign(count, 0.0);
  queue_ = ReadingQueue(slots(timing_), count);
}

bool Sensor::due() const {
  return failing() != Failure::kOff && timing_.samples_between(now_ns_, now_ns_ + timing_.tick_ns);
}

void Sensor::publish(std::span<const hwparts::JointSample>, std::span<double> sensor_outputs) {
  const bool samples = due();
  now_ns_ += timing_.tick_ns;
  if (samples) sample();
  if (silent_) changed_ += queue_.drop_overtaken(now_ns_);
  while (!silent_ && !queue_.empty() && queue_.front_due_ns() <= now_ns_) {
    std::ranges::copy(queue_.front(), shown_.begin());
    queue_.pop();
    show(shown_, sensor_outputs);
    sensor_outputs.back() = static_cast<double>(++changed_);
  }
}

void Sensor::sample() {
  ++samples_;
  if (lost()) return;
  if (failing() != Failure::kStuck) {
    read(truth_, last_, random_);
    disturb(last_);
  }
  queue_.push(now_ns_ + timing_.latency_ns + late_ns(), last_);
}

bool Sensor::lost() {
  if (failing() == Failure::kSlow) return samples_ % kSlowFactor != 0;
  return failing() == Failure::kIntermittent && random_.uniform() < kLossChance;
}

void Sensor::disturb(std::span<double> reading) {
  for (std::size_t i = 0; i < reading.size(); ++i) {
    const Accuracy& limits = layout_.numbers[i];
    if (failing() == Failure::kWrong) reading[i] = limits.lowest + limits.highest - reading[i];
    if (failing() == Failure::kGarbage)
      reading[i] = limits.lowest + random_.uniform() * (limits.highest - limits.lowest);
    reading[i] = quantised(limits, reading[i]);
  }
}

void Sensor::read(std::span<const double> truth, std::span<double> reading, Random& random) const {
  for (std::size_t i = 0; i < truth.size(); ++i)
    reading[i] = disturbed(layout_.numbers[i], truth[i], offsets_[i], random);
}

void Sensor::show(std::span<const double> reading, std::span<double> sensor_outputs) {
  std::ranges::copy(reading, sensor_outputs.begin());
}

void Sensor::draw_offsets() {
  for (std::size_t i = 0; i < offsets_.size(); ++i)
    offsets_[i] = layout_.numbers[i].bias > 0.0 ? layout_.numbers[i].bias * random_.normal() : 0.0;
}

void Sensor::reset() {
  random_ = Random(seed_, name_);
  draw_offsets();
  failure_ = initial_failure_;
  now_ns_ = samples_ = 0;
  changed_ = 0;
  for (std::size_t i = 0; i < last_.size(); ++i) last_[i] = quantised(layout_.numbers[i], layout_.nothing);
  shown_ = last_;
  queue_.clear();
  shown_again(shown_);
}

std::vector<protocol::Parameter> Sensor::parameters() const {
  protocol::Parameter failure;
  failure.name = kFailure;
  failure.help = "how the sensor fails; ok: it does not";
  failure.value = std::string(name_of(failure_));
  for (const auto& row : failure_names()) failure.choices.emplace_back(row.name);
  return {failure,
          fixed_number("Rate", "Hz", "samples per second", 1e9 / static_cast<double>(timing_.period_ns)),
          fixed_number("Latency", "s", "from the sample to the ports",
                       static_cast<double>(timing_.latency_ns) * 1e-9)};
}

std::optional<std::string> Sensor::set_parameter(const std::string& name,
                                                 const protocol::ParameterValue& value) {
  for (const auto& parameter : parameters())
    if (parameter.name == name && parameter.read_only) return "'" + name + "' can only be read";
  if (name != kFailure) return Part::set_parameter(name, value);
  const auto* word = std::get_if<std::string>(&value);
  std::string known;
  for (const auto& row : failure_names()) {
    if (word && *word == row.name) {
      if (const char* reason = why_not(row.failure)) return reason;
      fail(row.failure, by_fault_);
      return std::nullopt;
    }
    known += (known.empty() ? "" : ", ") + std::string(row.name);
  }
  return "must be one of " + known;
}

std::optional<std::string> Sensor::refuse_fault(const hwparts::Fault& fault) const {
  if (auto reason = Part::refuse_fault(fault)) return reason;
  if (const char* reason = why_not(failure_of(fault.kind))) return reason;
  const bool of_network =
      fault.kind == hwparts::FaultKind::kNetworkDelay || fault.kind == hwparts::FaultKind::kNetworkLoss;
  if (of_network && fills_blackboard())
    return "its readings are on a blackboard, which comes in time and whole; sensor_delayed and "
           "sensor_intermittent act on it";
  return std::nullopt;
}

void Sensor::set_faults(std::span<const hwparts::ActiveFault> faults) {
  Failure suffered = Failure::kOk;
  silent_ = false;
  for (const auto& active : faults) {
    if (const auto failure = failure_of(active.fault.kind); failure != Failure::kOk) suffered = failure;
    if (active.fault.kind == hwparts::FaultKind::kPartSilent) silent_ = true;
  }
  fail(failure_, suffered);
}

void Sensor::fail(Failure by_parameter, Failure by_fault) {
  const std::int64_t late_so_far_ns = late_ns();
  failure_ = by_parameter;
  by_fault_ = by_fault;
  if (late_ns() < late_so_far_ns) queue_.hasten(late_so_far_ns, now_ns_ + timing_.latency_ns);
}

void Sensor::save(hwparts::StateWriter& to) const {
  random_.save(to);
  to.put(failure_);
  to.put(now_ns_);
  to.put(samples_);
  to.put(changed_);
  to.put(std::span<const double>(last_));
  to.put(std::span<const double>(shown_));
  queue_.save(to);
}

void Sensor::load(hwparts::StateReader& from) {
  random_.load(from);
  from.get(failure_);
  if (!is_failure(failure_)) throw std::out_of_range("a sensor that fails in no known way");
  from.get(now_ns_);
  from.get(samples_);
  from.get(changed_);
  from.get(std::span<double>(last_));
  from.get(std::span<double>(shown_));
  queue_.load(from);
  shown_again(shown_);
}

void allow_keys(const config::Node& entry, std::initializer_list<std::string_view> own) {
  std::vector<std::string_view> keys{"name", "kind", "rate_hz", "latency_ms", "failure"};
  keys.insert(keys.end(), own);
  entry.allow_only(keys);
}

}  // namespace visum::sensors
