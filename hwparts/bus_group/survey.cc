#include "hwparts/bus_group/survey.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "hwparts/bus_group/parameter_ids.h"
#include "hwparts/drive/state_word.h"
#include "hwparts/powercube/settings.h"

namespace visum::bus_group {
namespace {

using powercube::Asker;
using powercube::Message;
namespace command = powercube::command;

constexpr double kSame = 1e-4;                     // relative tolerance of limits read back as 32-bit floats
constexpr std::int64_t kStranger_ns = 30'000'000;  // patience with ids that the configuration does not name
constexpr double kNearZero = 1e-6;                 // [u], absolute

struct Limit {
  std::uint8_t parameter;
  const char* name;
  double value;
};

std::vector<Limit> limits_of(const drive::DriveData& data) {
  std::vector<Limit> limits;
  if (data.limits.limited) {
    limits.push_back({kMinPos, "lowest position", data.limits.soft_minimum});
    limits.push_back({kMaxPos, "highest position", data.limits.soft_maximum});
  }
  limits.push_back({kMaxDeltaPos, "largest following error", data.limits.following_error});
  limits.push_back({kMaxVel, "maximum speed", data.limits.maximum_speed});
  limits.push_back({kMaxAcc, "maximum acceleration", data.limits.maximum_acceleration});
  limits.push_back({kMaxCur, "maximum current", data.motor.current_limit});
  return limits;
}

Message setting(std::uint8_t parameter, double value) {
  Message message{command::kSetParameter, parameter};
  powercube::put_value(message, static_cast<float>(value));
  return message;
}

bool same(double a, double b) {
  return std::abs(a - b) <= std::max(kSame * std::abs(b), kNearZero);
}

std::string in_words(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}

template <typename T>
std::optional<T> get(Asker& asker, int module, std::uint8_t parameter,
                     const std::optional<powercube::Patience>& patience = {}) {
  const auto answer = asker.ask_and_wait(module, {command::kGetParameter, parameter}, patience);
  if (!answer || answer->size < 2 + sizeof(T)) return std::nullopt;
  return powercube::value_at<T>(*answer, 2);
}

// The survey of one module: reads it, gives it its limits, and collects what is wrong with it.
class Visit {
 public:
  Visit(Asker& asker, const Expected& expected, bool watchdog)
      : asker_(asker), expected_(expected), module_(expected.data.module), watchdog_(watchdog) {}

  Found make(std::vector<std::string>& faults) {
    Found found;
    found.firmware = value<std::uint16_t>(kVersion, "version");
    found.serial_number = value<std::uint32_t>(kSerialNumber, "serial number");
    check_kind(value<std::uint32_t>(kDefConfig, "configuration"));
    if (expected_.serial_number && !failed_ && found.serial_number != *expected_.serial_number)
      complain("has the serial number " + std::to_string(found.serial_number) + ", not " +
               std::to_string(*expected_.serial_number));
    if (!failed_) set_limits();
    if (!failed_ && watchdog_) found.watchdog = enable_watchdog();
    found.state = value<std::uint32_t>(kState, "state");
    if (found.state & drive::state_bit::kMotion) complain("is moving");
    found.position = static_cast<double>(value<float>(kPosition, "position"));
    if (!std::isfinite(found.position)) complain("has a position that is not a finite number");
    faults.insert(faults.end(), faults_.begin(), faults_.end());
    return found;
  }

 private:
  template <typename T>
  T value(std::uint8_t parameter, const char* what) {
    const auto read = failed_ ? std::nullopt : get<T>(asker_, module_, parameter);
    if (!read && !failed_) complain(std::string("does not tell its ") + what);
    return read.value_or(T{});
  }

  void check_kind(std::uint32_t config) {
    const bool linear = (config & powercube::config_bit::kLinear) != 0;
    if (!failed_ && linear != expected_.data.linear)
      complain(std::string("is ") + (linear ? "linear" : "rotary") + ", the configuration has a " +
               (linear ? "rotary" : "linear") + " drive there");
  }

  void set_limits() {
    for (const auto& limit : limits_of(expected_.data)) {
      asker_.ask_and_wait(module_, setting(limit.parameter, limit.value));
      const auto now = get<float>(asker_, module_, limit.parameter);
      if (now && same(static_cast<double>(*now), limit.value)) continue;
      complain(std::string("does not take ") + in_words(limit.value) + " as its " + limit.name +
               (now ? " and keeps " + in_words(static_cast<double>(*now)) : ""));
    }
  }

  Message enable_watchdog() {
    const auto config = value<std::uint32_t>(kConfig, "configuration");
    Message message{command::kSetParameter, kConfig};
    powercube::put_value(message, config | powercube::config_bit::kWatchdogEnable);
    const auto answer = asker_.ask_and_wait(module_, message);
    if (!answer || answer->size < 3 || answer->data[2] != powercube::kDone)
      complain("does not take a watchdog");
    return message;
  }

  void complain(const std::string& what) {
    failed_ = true;
    faults_.push_back("module " + std::to_string(module_) + " " + what);
  }

  Asker& asker_;
  const Expected& expected_;
  int module_;
  bool watchdog_;
  bool failed_ = false;
  std::vector<std::string> faults_;
};

std::string list_of(const std::vector<int>& ids) {
  std::string text;
  for (const int id : ids) text += (text.empty() ? "" : ", ") + std::to_string(id);
  return text.empty() ? "none" : text;
}

// Every id that answers. Expected ids are asked with the usual patience, the others once.
std::vector<int> scan(Asker& asker, std::span<const Expected> expected) {
  const powercube::Patience once{std::min(asker.patience().answer_ns, kStranger_ns), 1};
  std::vector<int> there;
  for (int id = 1; id <= powercube::kMaxModule; ++id) {
    const auto is = [id](const Expected& module) { return module.data.module == id; };
    const bool known = std::ranges::any_of(expected, is);
    if (get<std::uint16_t>(asker, id, kVersion, known ? asker.patience() : once)) there.push_back(id);
  }
  return there;
}

}  // namespace

std::vector<Message> limit_settings(const drive::DriveData& data) {
  std::vector<Message> messages;
  for (const auto& limit : limits_of(data)) messages.push_back(setting(limit.parameter, limit.value));
  return messages;
}

std::vector<Found> survey(Asker& asker, std::span<const Expected> expected, bool watchdog) {
  const auto there = scan(asker, expected);
  std::vector<std::string> faults;
  std::vector<Found> found;
  for (const auto& module : expected) {
    if (std::ranges::find(there, module.data.module) != there.end())
      found.push_back(Visit(asker, module, watchdog).make(faults));
    else
      faults.push_back("module " + std::to_string(module.data.module) +
                       " does not answer; on the bus are: " + list_of(there));
  }
  if (faults.empty()) return found;
  std::string text = asker.line().name() + " is not the bus of this part:";
  for (const auto& fault : faults) text += "\n  " + fault;
  throw std::runtime_error(text);
}

}  // namespace visum::bus_group
