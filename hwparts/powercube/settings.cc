#include "hwparts/powercube/settings.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <span>
#include <string>

namespace visum::powercube {
namespace {

using config::Node;

// The bits of the setup word (parameter 0x58).
constexpr std::uint32_t kEncoder = 0x001, kAbsoluteFeedback = 0x004, kFourInFourOut = 0x008, kRs232 = 0x040,
                        kCan = 0x200;

// Reads a whole number from 0 to `most`, decimal or hexadecimal ("0x3521").
std::uint32_t word(const Node& node, std::uint32_t most) {
  const std::string text = node.text();
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const char* begin = text.data() + (hexadecimal ? 2 : 0);
  const char* end = text.data() + text.size();
  std::uint32_t value = 0;
  const auto [stopped, error] = std::from_chars(begin, end, value, hexadecimal ? 16 : 10);
  if (error != std::errc() || stopped != end || begin == end || value > most)
    node.fail("must be a whole number from 0 to " + std::to_string(most) + ", decimal or as 0x...");
  return value;
}

void allow_keys(const Node& node, bool exceptions) {
  std::vector<std::string_view> known{"firmware",      "config",     "serial_number",  "counts_from_zero",
                                      "beyond_limits", "third_step", "above_maximum",  "refused",
                                      "refused_byte",  "watchdog_s", "state_period_s", "rs232_broadcasts"};
  if (exceptions) known.emplace_back("each");
  node.allow_only(known);
}

void read_identity(const Node& node, Settings& settings) {
  constexpr std::uint32_t kAny = std::numeric_limits<std::uint32_t>::max();
  if (const auto at = node.find("firmware")) {
    settings.firmware = static_cast<std::uint16_t>(word(*at, 0xFFFF));
    if (settings.firmware != kIncremental && settings.firmware != kAbsolute)
      at->fail("must be 0x3521 (incremental encoder) or 0x4634 (absolute encoder)");
  }
  if (const auto at = node.find("config")) settings.config = word(*at, kAny);
  if (const auto at = node.find("serial_number")) settings.serial_number = word(*at, kAny);
  settings.counts_from_zero = node.boolean_or("counts_from_zero", settings.counts_from_zero);
}

void read_behaviour(const Node& node, Settings& settings) {
  if (const auto at = node.find("beyond_limits")) {
    const auto choice = at->one_of({"stop", "clamp", "refuse"});
    settings.beyond_limits = choice == "stop"    ? BeyondLimits::kStop
                             : choice == "clamp" ? BeyondLimits::kClamp
                                                 : BeyondLimits::kRefuse;
  }
  if (const auto at = node.find("third_step")) {
    const auto choice = at->one_of({"advance", "replace", "refuse"});
    settings.third_step = choice == "advance"   ? ThirdStep::kAdvance
                          : choice == "replace" ? ThirdStep::kReplace
                                                : ThirdStep::kRefuse;
  }
  if (const auto at = node.find("above_maximum"))
    settings.above_maximum =
        at->one_of({"clamp", "refuse"}) == "clamp" ? AboveMaximum::kClamp : AboveMaximum::kRefuse;
  if (const auto at = node.find("refused"))
    settings.answers_refused = at->one_of({"answer", "silence"}) == "answer";
  if (const auto at = node.find("refused_byte"))
    settings.refused_byte = static_cast<std::uint8_t>(word(*at, 0xFF));
  settings.serial_broadcasts = node.boolean_or("rs232_broadcasts", settings.serial_broadcasts);
  settings.watchdog_s = node.number_or("watchdog_s", settings.watchdog_s, {1e-3, 3600.0});
  settings.state_period_s = node.number_or("state_period_s", settings.state_period_s, {1e-3, 3600.0});
}

std::optional<Node> exception_for(const Node& modules, int module) {
  const auto each = modules.find("each");
  return each ? each->find(std::to_string(module)) : std::nullopt;
}

}  // namespace

Settings read_settings(const Node& part, const drive::DriveData& data, bool part_homed) {
  Settings settings;
  settings.firmware = part_homed ? kAbsolute : kIncremental;
  settings.config = config_bit::kSwrEnabled | (data.brake.present ? config_bit::kBrakePresent : 0) |
                    (data.linear ? config_bit::kLinear : 0);
  settings.serial_number = 40000u + static_cast<std::uint32_t>(data.module);
  bool said = false;
  if (const auto modules = part.find("modules")) {
    allow_keys(*modules, true);
    read_identity(*modules, settings);
    read_behaviour(*modules, settings);
    said = modules->find("firmware").has_value();
    if (const auto exception = exception_for(*modules, data.module)) {
      allow_keys(*exception, false);
      read_identity(*exception, settings);
      read_behaviour(*exception, settings);
      said = said || exception->find("firmware").has_value();
    }
  }
  const bool absolute = settings.firmware == kAbsolute;
  settings.setup = (absolute ? kAbsoluteFeedback : kEncoder) | kFourInFourOut | kRs232 | kCan;
  settings.homed = part_homed || (said && absolute);
  return settings;
}

std::optional<std::uint32_t> stated_serial_number(const Node& part, int module) {
  const auto modules = part.find("modules");
  const auto exception = modules ? exception_for(*modules, module) : std::nullopt;
  const auto at = exception ? exception->find("serial_number") : std::nullopt;
  if (!at) return std::nullopt;
  return word(*at, std::numeric_limits<std::uint32_t>::max());
}

void check_exceptions(const Node& part, std::span<const int> modules) {
  const auto entry = part.find("modules");
  const auto each = entry ? entry->find("each") : std::nullopt;
  if (!each) return;
  for (const auto& key : each->keys()) {
    const auto is = [&](int module) { return std::to_string(module) == key; };
    if (std::ranges::none_of(modules, is)) each->get(key).fail("the part has no module " + key);
  }
}

}  // namespace visum::powercube
