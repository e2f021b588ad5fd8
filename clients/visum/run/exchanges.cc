#include "clients/visum/run/exchanges.h"

#include <algorithm>
#include <set>
#include <string_view>

#include "clients/visum/run/placeholders.h"
#include "clients/visum/run/session.h"

namespace visum::run {
namespace {

using protocol::Exchange;

struct Names {
  std::set<std::string> clients, buses;  // buses: by their part
};

Names names_of(const ControllerSpec& controller) {
  constexpr std::string_view kPorts = "ports:";  // a gate for the sessions of another name
  Names names{{controller.client}, {}};
  if (controller.gate.starts_with(kPorts)) names.clients.insert(controller.gate.substr(kPorts.size()));
  for (const std::string& word : controller.command)
    for (const std::string& part : parts_with_bus(word)) names.buses.insert(part);
  return names;
}

bool has_one_of(const std::vector<Exchange>& exchanges, const std::set<std::string>& names) {
  return std::ranges::any_of(exchanges,
                             [&](const Exchange& one) { return one.count > 0 && names.contains(one.name); });
}

bool has_others(const std::vector<Exchange>& exchanges, const std::set<std::string>& names) {
  return std::ranges::any_of(exchanges,
                             [&](const Exchange& one) { return one.count > 0 && !names.contains(one.name); });
}

}  // namespace

std::string find_silent_controller(const std::vector<ControllerSpec>& controllers,
                                   const protocol::ServerStatus& status) {
  Names all{{Session::kName, Session::kWaiterName}, {}};
  for (const ControllerSpec& controller : controllers) {
    const Names names = names_of(controller);
    all.clients.insert(names.clients.begin(), names.clients.end());
    all.buses.insert(names.buses.begin(), names.buses.end());
  }
  if (has_others(status.exchanges, all.clients) || has_others(status.bus_exchanges, all.buses)) return {};
  for (const ControllerSpec& controller : controllers) {
    // A bridge is a controller, too, so it is looked at by itself.
    if (!controller.exchanges || !controller.through.empty()) continue;
    const Names names = names_of(controller);
    if (!has_one_of(status.exchanges, names.clients) && !has_one_of(status.bus_exchanges, names.buses))
      return "controller '" + controller.name +
             "' exchanged nothing with a part; for a program that is not to, say 'exchanges: false'";
  }
  return {};
}

}  // namespace visum::run
