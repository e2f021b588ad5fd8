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

// Finds who exchanged something, as "client 'x'" or "the bus of 'arm'": those of `names`, or all others.
std::vector<std::string> find_active(const protocol::ServerStatus& status, const Names& names,
                                     bool others = false) {
  std::vector<std::string> active;
  const auto add = [&](const std::vector<Exchange>& exchanges, const std::set<std::string>& own,
                       const char* what) {
    for (const Exchange& one : exchanges)
      if (one.count > 0 && own.contains(one.name) != others) active.push_back(what + ("'" + one.name + "'"));
  };
  add(status.exchanges, names.clients, "client ");
  add(status.bus_exchanges, names.buses, "the bus of ");
  return active;
}

// A bridge is a controller, too, so it is looked at by itself.
bool must_exchange(const ControllerSpec& controller) {
  return controller.exchanges && controller.through.empty();
}

// Finds another controller that is to exchange something and has this active name, too. nullptr: there is
// none.
const ControllerSpec* find_sharer(const std::vector<ControllerSpec>& controllers,
                                  const ControllerSpec& controller, const protocol::ServerStatus& status,
                                  const std::string& active) {
  const auto shares = [&](const ControllerSpec& other) {
    return &other != &controller && must_exchange(other) &&
           std::ranges::count(find_active(status, names_of(other)), active) > 0;
  };
  const auto found = std::ranges::find_if(controllers, shares);
  return found == controllers.end() ? nullptr : &*found;
}

// Says why it is not known of this controller that it exchanged something. Empty: it is known.
std::string find_doubt(const std::vector<ControllerSpec>& controllers, const ControllerSpec& controller,
                       const protocol::ServerStatus& status, const std::string& others) {
  std::string doubt;
  for (const std::string& active : find_active(status, names_of(controller))) {
    const ControllerSpec* const sharer = find_sharer(controllers, controller, status, active);
    if (!sharer) return {};
    doubt = active + " exchanged something, but is controller '" + controller.name + "' as well as '" +
            sharer->name +
            "', so that either may have been silent: give each a name or a bus of its own, or " +
            "say 'exchanges: false' for the one that may be silent";
  }
  if (!doubt.empty()) return doubt;
  const std::string silent = "controller '" + controller.name + "' exchanged nothing with a part";
  if (others.empty()) return silent + "; for a program that is not to, say 'exchanges: false'";
  return silent + " as client '" + controller.client + "'; " + others +
         " did, and no controller has that name: say 'client: NAME', or name {bus.PART} in 'command'";
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
  std::string others;
  for (const std::string& other : find_active(status, all, true))
    others += (others.empty() ? "" : ", ") + other;
  if (controllers.size() == 1 && !others.empty()) return {};
  for (const ControllerSpec& controller : controllers) {
    if (!must_exchange(controller)) continue;
    if (std::string doubt = find_doubt(controllers, controller, status, others); !doubt.empty()) return doubt;
  }
  return {};
}

}  // namespace visum::run
