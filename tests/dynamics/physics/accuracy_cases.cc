// P4, P6, P7, P8: accuracy, order, reversibility, and errors over a long time.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

double tip_error(const Lab& lab, const TipAt& tip) {
  const world::BodyId last{static_cast<std::int32_t>(lab.model.bodies.size() - 1)};
  return (point_of(lab.model, lab.state, last, kArm7Tip) - tip.p_W).norm();
}

std::vector<double> swing_free(const world::EngineSetting& engine) {
  Lab lab(arm7(engine, 1e-3));
  std::vector<double> figures;
  double gap = 0.0, before = 0.0;
  for (const TipAt& tip : arm7_tips()) {
    watch(lab, tip.time_s - before, [&] { gap = std::max(gap, max_gap(lab.model, lab.state)); });
    before = tip.time_s;
    figures.push_back(tip_error(lab, tip));
  }
  figures.push_back(gap);
  return figures;
}

double swing_error(const world::EngineSetting& engine, double tick_s, const TipAt& end) {
  Lab lab(arm7(engine, tick_s));
  lab.run(end.time_s);
  return tip_error(lab, end);
}

// The slope of log(error) over log(step), by least squares, over a decade of steps above those where rounding
// shows.
double measured_order(const world::EngineSetting& engine, const std::vector<double>& ticks_s,
                      const TipAt& end) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const double tick_s : ticks_s) {
    const double u = std::log(tick_s), v = std::log(swing_error(engine, tick_s, end));
    n += 1.0, x += u, y += v, xx += u * u, xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

// An engine without the setting is of order 1, as it says itself.
std::vector<double> converge(const world::EngineSetting& engine) {
  const bool fine = engine.name != "impulse" || engine.order == 2;
  const int promised = engine.name == "impulse" ? engine.order : 1;
  const double order = fine ? measured_order(engine, {2e-3, 1e-3, 5e-4, 2e-4}, arm7_tips()[1])
                            : measured_order(engine, {1e-2, 5e-3, 4e-3, 2e-3, 1e-3}, arm7_tips()[2]);
  return {std::abs(order - promised) / promised};
}

std::vector<double> swing_and_return(const world::EngineSetting& engine) {
  auto exact = engine;
  exact.d_max = 1e-12;
  Lab lab(double_pendulum(exact, 1e-3));
  const auto start = lab.state;
  lab.run(1.0);
  for (auto& body : lab.state.bodies) body.v_WC = -body.v_WC, body.w_WB = -body.w_WB;
  lab.run(1.0);
  double error = 0.0;
  for (std::size_t i = 0; i < start.bodies.size(); ++i)
    error = std::max(error, (lab.state.bodies[i].p_WC - start.bodies[i].p_WC).norm());
  return {error};
}

// The mean energy error of the last tenth, against that of the first. It shows a slope, but no oscillation.
std::vector<double> swing_for_long(const world::EngineSetting& engine) {
  constexpr double kSeconds = 1000.0;
  Lab lab(double_pendulum(engine, 1e-3));
  const double energy = energy_of(lab.model, lab.state), scale = energy_scale(lab.model);
  double first = 0.0, last = 0.0, largest = 0.0;
  const auto mean_over = [&](double seconds, double& mean) {
    const double share = lab.tick_s() / seconds;
    watch(lab, seconds, [&] {
      const double error = (energy_of(lab.model, lab.state) - energy) / scale;
      mean += share * error;
      largest = std::max(largest, std::abs(error));
    });
  };
  mean_over(0.1 * kSeconds, first);
  lab.run(0.8 * kSeconds);
  mean_over(0.1 * kSeconds, last);
  return {std::abs(last - first), largest};
}

}  // namespace

std::vector<Case> accuracy_cases() {
  return {
      {"P4",
       "ArmSwingsFree",
       "Gragg-Bulirsch-Stoer in long double, two step sizes agree to 1e-11",
       {{"tip_025s_m", 1e-4},
        {"tip_05s_m", 1e-3},
        {"tip_1s_m", 1e-3, 1e-7, 1e-7},
        {"tip_2s_m", 1e-1},
        gap_figure("gap_m")},
       swing_free},
      {"P6",
       "ErrorFallsWithTheOrderPromised",
       "slope of log(tip error at 0.5 s or 1 s) over log(step); reference as P4",
       {{"order", 0.05}},
       converge},
      {"P7",
       "MotionRunsBackwards",
       "closed form: the equations are reversible; 1 s on, 1 s back",
       {{"position_m", 1e-9}},
       swing_and_return},
      {"P8",
       "EnergyHasNoSlopeOver1000s",
       "closed form: E constant",
       {{"slope", 1e-5}, {"energy", 1e-3}},
       swing_for_long,
       true},
  };
}

}  // namespace visum::physics
