#include "tests/dynamics/physics/engine_rows.h"

#include <algorithm>
#include <stdexcept>

#include "server/dynamics/kinds/engine_kinds.h"

namespace visum::physics {
namespace {

// QuickStep with its own default of 20 sweeps, as users of ODE run it.
world::EngineSetting ode(const std::string& step) {
  world::EngineSetting setting;
  setting.name = "ode";
  setting.step = step;
  return setting;
}

world::EngineSetting impulse(int order) {
  world::EngineSetting setting;
  setting.name = "impulse";
  setting.order = order;
  return setting;
}

world::EngineSetting iterate() {
  world::EngineSetting setting = impulse(2);
  setting.solver = "iterate";
  return setting;
}

bool is_built(const EngineRow& row) {
  return std::ranges::any_of(dynamics::engine_kinds(),
                             [&](const auto& kind) { return row.setting.name == kind.name; });
}

std::vector<EngineRow> built_rows() {
  std::vector<EngineRow> rows{{"impulse", impulse(2)},        {"impulse-order4", impulse(4)},
                              {"impulse-order6", impulse(6)}, {"impulse-iterate", iterate()},
                              {"ode", ode("world")},          {"ode-quick", ode("quick")}};
  std::erase_if(rows, [](const EngineRow& row) { return !is_built(row); });
  return rows;
}

}  // namespace

const std::vector<EngineRow>& engine_rows() {
  static const std::vector<EngineRow> rows = built_rows();
  return rows;
}

const EngineRow& engine_row(const std::string& name) {
  const auto found = std::ranges::find(engine_rows(), name, &EngineRow::name);
  if (found == engine_rows().end()) throw std::runtime_error("there is no engine row '" + name + "'");
  return *found;
}

}  // namespace visum::physics
