#include "tests/dynamics/contract/rows.h"

namespace visum::dynamics::testing {
namespace {

world::EngineSetting ode(const std::string& step, int iterations) {
  world::EngineSetting setting;
  setting.name = "ode";
  setting.step = step;
  setting.iterations = iterations;
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

}  // namespace

// ODE is semi-implicit: it misses the parabola by g h t / 2 = 4.9 mm after 1 s with steps of 1 ms.
const std::vector<Row>& rows() {
  static const std::vector<Row> all{
      {"OdeWorld", ode("world", 20), {4.91e-3, 1e-9, 1e-3, 5e-3, 1e-3, 2e-3, 1e-6, 1e-5, 1e-5}},
      {"OdeQuick", ode("quick", 50), {4.91e-3, 1e-3, 1e-3, 5e-3, 2e-2, 2e-3, 1e-3, 5e-3, 5e-3}},
      {"Impulse", impulse(2), {1e-10, 1e-9, 1e-7, 1e-5, 1e-4, 1e-3, 1e-9, 1e-6, 1e-6}},
      {"ImpulseOrder4", impulse(4), {1e-10, 1e-9, 1e-10, 1e-8, 1e-4, 1e-3, 1e-9, 1e-6, 1e-6}},
      {"ImpulseIterate", iterate(), {1e-10, 1e-6, 2e-6, 1e-5, 1e-4, 1e-3, 1e-9, 1e-6, 1e-6}},
  };
  return all;
}

}  // namespace visum::dynamics::testing
