#include "clients/visum/run/timeline.h"

#include <algorithm>
#include <limits>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/parameters.h"
#include "clients/visum/run/bounds.h"
#include "clients/visum/run/lookup.h"

namespace visum::run {
namespace {

constexpr double kRounding_s = 1e-9;  // see check.cc

// Finds names that do not exist in an action, before the first tick.
struct Inspector {
  const Catalogue& catalogue;
  const config::Place& place;

  void operator()(const SetPort& set) const {
    const auto found = find_port(find_part(catalogue, set.part, place), set.port, place);
    if (found.output)
      throw config::ConfigError(place, "'" + set.port + "' is a sensor output and cannot be set");
    if (set.value < found.port->minimum || set.value > found.port->maximum) {
      throw config::ConfigError(place, "port '" + set.port + "' takes " + cli::exact(found.port->minimum) +
                                           " .. " + cli::exact(found.port->maximum) + ", not " +
                                           cli::exact(set.value));
    }
  }
  void operator()(const Push& push) const { find_body(catalogue, push.body, place); }
  void operator()(const RemoveBody& remove) const { find_body(catalogue, remove.body, place); }
  void operator()(const SetParameter& set) const {
    std::vector<std::string> known;
    for (const auto& parameter : find_part(catalogue, set.part, place).parameters) {
      if (parameter.name == set.name) return check_value(parameter, set.value);
      known.push_back(parameter.name);
    }
    fail_unknown(place, "parameter of part '" + set.part + "' called", set.name, known);
  }
  void check_value(const protocol::Parameter& parameter, const std::string& value) const {
    try {
      cli::parse_value(parameter, value);
    } catch (const cli::ExitError& error) {
      throw config::ConfigError(place, error.what());
    }
  }
  void operator()(const InjectFault& fault) const {
    const auto& kind = find_fault(catalogue, fault.part, fault.kind, place);
    std::vector<std::string> known;
    for (const auto& number : kind.numbers) known.push_back(number.name);
    for (const auto& [name, value] : fault.numbers)
      if (std::ranges::find(known, name) == known.end())
        fail_unknown(place, "number of fault '" + fault.kind + "' called", name, known);
  }
  void operator()(const ClearFault& clear) const {
    find_part(catalogue, clear.part, place);
    if (!clear.kind.empty()) find_fault(catalogue, clear.part, clear.kind, place);
  }
  void operator()(const Signal&) const {}
  void operator()(const Say&) const {}
};

void inspect(const TimelineEntry& entry, const Catalogue& catalogue) {
  std::visit(Inspector{catalogue, entry.place}, entry.action);
}

}  // namespace

Timeline::Timeline(const std::vector<TimelineEntry>& entries, const Catalogue& catalogue) {
  for (const TimelineEntry& entry : entries) {
    inspect(entry, catalogue);
    items_.push_back({&entry, std::nullopt});
    if (entry.when) items_.back().quantity = tie(entry.when->quantity, catalogue);
  }
}

void Timeline::tie_again(const Catalogue& catalogue) {
  for (Item& item : items_) {
    if (item.done) continue;
    inspect(*item.entry, catalogue);
    if (item.quantity) run::tie_again(*item.quantity, catalogue);
  }
}

std::vector<const TimelineEntry*> Timeline::due(const Observation& now) {
  const double now_s = static_cast<double>(now.world.sim_time_ns) * 1e-9;
  std::vector<const TimelineEntry*> due;
  for (Item& item : items_) {
    if (item.done) continue;
    item.done = item.quantity ? holds(item.entry->when->bounds, item.quantity->measure(*item.quantity, now))
                              : now_s >= item.entry->at_s - kRounding_s;
    if (item.done) due.push_back(item.entry);
  }
  return due;
}

bool Timeline::has_conditions() const {
  return std::ranges::any_of(items_, [](const Item& item) { return !item.done && item.quantity; });
}

double Timeline::next_s() const {
  double next_s = std::numeric_limits<double>::infinity();
  for (const Item& item : items_)
    if (!item.done && !item.quantity) next_s = std::min(next_s, item.entry->at_s);
  return next_s;
}

std::vector<const TimelineEntry*> Timeline::missed() const {
  std::vector<const TimelineEntry*> missed;
  for (const Item& item : items_) {
    if (!item.done) missed.push_back(item.entry);
  }
  return missed;
}

}  // namespace visum::run
