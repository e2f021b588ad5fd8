#include "server/bus/address.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"
#include "server/bus/bus_link.h"

namespace visum::bus {
namespace {

constexpr double kLeastBaud = 300.0, kMostBaud = 1e7;
constexpr double kMostDelay_ms = 1e4;

[[noreturn]] void fail(const std::string& text, const std::string& why) {
  throw std::runtime_error("'" + text + "' is no bus: " + why);
}

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const BusKind& row : bus_kinds()) names.emplace_back(row.name);
  return names;
}

std::string known_kinds() {
  std::string kinds;
  for (const auto& row : bus_kinds()) kinds += (kinds.empty() ? "" : ", ") + std::string(row.name);
  return kinds;
}

double number_after(const std::string& option, std::size_t at, double least, double most) {
  double value = 0.0;
  const char* end = option.data() + option.size();
  const auto [stopped, error] = std::from_chars(option.data() + at, end, value);
  if (error != std::errc() || stopped != end || !(value >= least && value <= most))
    fail(option, "the number must be between " + std::to_string(static_cast<long>(least)) + " and " +
                     std::to_string(static_cast<long>(most)));
  return value;
}

void read_option(const std::string& option, BusTiming& timing) {
  if (option.starts_with("baud=")) {
    timing.baud = number_after(option, 5, kLeastBaud, kMostBaud);
  } else if (option.starts_with("delay_ms=")) {
    timing.delay_ns = static_cast<std::int64_t>(number_after(option, 9, 0.0, kMostDelay_ms) * 1e6);
  } else {
    fail(option, "the options are baud=N and delay_ms=X" +
                     config::did_you_mean(option.substr(0, option.find('=')), {"baud", "delay_ms"}));
  }
}

// "KIND:WHERE[,option...]"
BusAddress parse(const std::string& part, const std::string& text) {
  const auto colon = text.find(':');
  BusAddress address{part, text.substr(0, colon), {}, {}};
  const auto is = [&](const BusKind& row) { return address.kind == row.name; };
  if (colon == std::string::npos || std::ranges::none_of(bus_kinds(), is))
    fail(text, "it must begin with its kind and a colon; there are: " + known_kinds() +
                   config::did_you_mean(address.kind, kind_names()));
  auto comma = text.find(',', colon);
  address.where = text.substr(colon + 1, comma == std::string::npos ? comma : comma - colon - 1);
  if (address.where.empty()) fail(text, "nothing stands behind the colon");
  while (comma != std::string::npos) {
    const auto next = text.find(',', comma + 1);
    read_option(text.substr(comma + 1, next == std::string::npos ? next : next - comma - 1), address.timing);
    comma = next;
  }
  return address;
}

BusAddress parse(const std::string& part, const config::Node& node) {
  try {
    return parse(part, node.text());
  } catch (const config::ConfigError&) {
    throw;
  } catch (const std::runtime_error& error) {
    node.fail(error.what());
  }
}

}  // namespace

BusAddress parse_bus(const std::string& text, const scene::Scene& scene) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals > text.find(':')) fail(text, "it must begin with PART=");
  const std::string part = text.substr(0, equals);
  std::vector<std::string> names;
  for (const auto& plan : scene.parts) names.push_back(plan.context.name);
  if (!part.empty() && std::ranges::find(names, part) == names.end())
    fail(text, config::unknown_name("part", part, names));
  return parse(part, text.substr(equals + 1));
}

std::vector<BusAddress> scene_buses(const scene::Scene& scene) {
  std::vector<BusAddress> addresses;
  for (const auto& plan : scene.parts) {
    const auto bus = plan.context.config.find("bus");
    if (!bus) continue;
    if (bus->kind() != config::Node::Kind::kList) {
      addresses.push_back(parse(plan.context.name, *bus));
      continue;
    }
    for (std::size_t i = 0; i < bus->size(); ++i) addresses.push_back(parse(plan.context.name, bus->at(i)));
  }
  return addresses;
}

}  // namespace visum::bus
