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

// "client 'somebody', the bus of 'arm'": exchanged something, and no controller has that name.
std::string names_of_nobody(const protocol::ServerStatus& status, const Names& known) {
  std::string text;
  const auto add = [&](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  for (const Exchange& one : status.exchanges)
    if (one.count > 0 && !known.clients.contains(one.name)) add("client '" + one.name + "'");
  for (const Exchange& one : status.bus_exchanges)
    if (one.count > 0 && !known.buses.contains(one.name)) add("the bus of '" + one.name + "'");
  return text;
}

// A bridge is a controller, too, so it is looked at by itself.
bool must_exchange(const ControllerSpec& controller) {
  return controller.exchanges && controller.through.empty();
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
  const std::string others = names_of_nobody(status, all);
  if (controllers.size() == 1 && !others.empty()) return {};
  for (const ControllerSpec& controller : controllers) {
    const Names names = names_of(controller);
    if (!must_exchange(controller) || has_one_of(status.exchanges, names.clients) ||
        has_one_of(status.bus_exchanges, names.buses))
      continue;
    const std::string silent = "controller '" + controller.name + "' exchanged nothing with a part";
    if (others.empty()) return silent + "; for a program that is not to, say 'exchanges: false'";
    return silent + " as client '" + controller.client + "'; " + others +
           " did, and no controller has that name: say 'client: NAME', or name {bus.PART} in 'command'";
  }
  return {};
}

}  // namespace visum::run
