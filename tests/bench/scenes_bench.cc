// Many bodies that touch: Scene/<what>/<n>/<engine>, the mean time of a tick of 1 ms over a fixed run from
// the same start, so that all engines are measured in the same events; resting_<what> has come to rest
// before. Counters at the run's end: depth_m, the deepest overlap, as our collision stage sees it; gap_m, the
// largest gap of a joint, where there are joints; speed_m_per_s, of the fastest body; warned, the ticks that
// ended with a solver warning (ours only).
// Threads/<what>/<n>/<threads>: the same of `impulse` alone, in wall time.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <stdexcept>

#include "server/collision/collision.h"
#include "tests/bench/stepper_kinds.h"
#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/legged_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::bench {
namespace {

constexpr double kTick = 1e-3;
constexpr std::size_t kMostForDirect = 40;  // bodies; beyond, a tick of ODE's dWorldStep takes seconds

struct SceneCase {
  std::string name;
  world::WorldModel model;
  int ticks;       // of the run
  int before = 0;  // ticks that are made before it, and not measured
};

world::EngineSetting any_engine() {
  return physics::engine_rows().front().setting;  // each stepper sets its own
}

std::vector<SceneCase> scene_cases() {
  using namespace physics;
  std::vector<SceneCase> cases;
  const auto add = [&](const std::string& name, int n, const world::WorldModel& model, int ticks,
                       int before = 0) {
    if (model.bodies.size() > world::kMaxBodies) throw std::logic_error(name + " has too many bodies");
    cases.push_back({name + "/" + std::to_string(n), model, ticks, before});
  };
  // How many, and ticks: the more, the fewer of the first events. The largest are what a world may hold:
  // 10,000 bodies, and 20,000 contacts.
  using Size = std::pair<int, int>;
  for (const auto& [boxes, ticks] : {Size(10, 4000), Size(30, 4000), Size(100, 600), Size(1000, 500)})
    add("pile", boxes, piles(any_engine(), kTick, 1, boxes), ticks);
  for (const auto& [count, ticks] :
       {Size(1, 600), Size(2, 600), Size(4, 600), Size(8, 600), Size(100, 600), Size(400, 300)})
    add("piles", count, piles(any_engine(), kTick, count, 10), ticks);
  for (const auto& [count, ticks] : {Size(1, 300), Size(10, 300), Size(100, 100), Size(400, 30)})
    add("towers", count, towers(any_engine(), kTick, count, 10), ticks);
  for (const auto& [side, ticks] : {Size(3, 1000), Size(10, 1000), Size(32, 300)})
    add("standing_wall", side, standing_wall(any_engine(), kTick, side), ticks);
  for (const auto& [side, ticks] : {Size(3, 300), Size(10, 100), Size(32, 30)})
    add("falling_wall", side, falling_wall(any_engine(), kTick, side), ticks);
  for (const auto& [height, ticks] :
       {Size(1, 1000), Size(10, 1000), Size(50, 1000), Size(100, 1000), Size(1000, 100)})
    add("stack", height, stack(any_engine(), kTick, height), ticks);
  // The same once all has come to rest.
  for (const auto& [boxes, before] : {Size(10, 4000), Size(30, 4000), Size(100, 9000)})
    add("resting_pile", boxes, piles(any_engine(), kTick, 1, boxes), 200, before);
  for (const auto& [side, before] : {Size(10, 300), Size(32, 300)})
    add("resting_wall", side, standing_wall(any_engine(), kTick, side), 100, before);
  for (const auto& [count, before] : {Size(10, 200), Size(100, 200)})
    add("resting_towers", count, towers(any_engine(), kTick, count, 10), 100, before);
  for (const int count : {1, 10, 100})
    add("ragdolls", count, falling_ragdolls(any_engine(), kTick, count), 1500);
  for (const auto& [count, ticks] : {Size(1, 500), Size(10, 500), Size(100, 500), Size(500, 100)}) {
    add("quadrupeds", count, standing_quadrupeds(any_engine(), kTick, count, Held::kByFriction), ticks);
    add("sprung_quadrupeds", count, standing_quadrupeds(any_engine(), kTick, count, Held::kBySprings), ticks);
    add("linkages", count, standing_linkages(any_engine(), kTick, count), ticks);
  }
  return cases;
}

// Rows of other orders are left out: where bodies touch, they take the same steps or say nothing new.
bool is_compared(const SceneCase& what, const std::string& row) {
  for (const char* other : {"impulse-order4", "impulse-order6", "impulse-iterate", "mujoco-rk4"})
    if (row == other) return false;
  if (row.starts_with("ode") && has_springs(what.model)) return false;  // ODE has none
  return row != "ode" || what.model.bodies.size() <= kMostForDirect;
}

void judge(benchmark::State& state, const SceneCase& what, const Stepper& stepper) {
  world::WorldState now = initial_state(what.model);
  stepper.store(now);
  collision::CollisionStage stage(what.model);
  std::vector<collision::Contact> contacts;
  stage.find(now, contacts);
  double depth = 0.0, speed = 0.0;
  for (const auto& contact : contacts) depth = std::max(depth, contact.depth);
  for (const auto& body : now.bodies) speed = std::max(speed, body.v_WC.norm());
  state.counters["depth_m"] = depth;
  state.counters["speed_m_per_s"] = speed;
  if (!what.model.joints.empty()) {
    measure_joints(what.model, now);
    state.counters["gap_m"] = physics::max_gap(what.model, now);
  }
  state.counters["warned"] = stepper.warned_ticks();
}

void run(benchmark::State& state, const SceneCase& what, const StepperKind& kind) {
  try {
    const auto stepper = kind.make(what.model, kind.name);
    for (int tick = 0; tick < what.before; ++tick) stepper->step();
    for (auto _ : state) stepper->step();
    judge(state, what, *stepper);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}

// Wall time counts: the processor's time of other threads is not seen.
void run_with_threads(benchmark::State& state, const SceneCase& what, int threads) {
  world::WorldModel model = what.model;
  world::EngineSetting setting = physics::engine_row("impulse").setting;
  setting.threads = threads;
  model.engines.assign(model.engines.size(), setting);
  dynamics::testing::Lab lab(std::move(model));
  for (auto _ : state) lab.step();
}

// Those whose cost is shown with one and with more threads.
bool is_of_islands(const SceneCase& what) {
  for (const char* name : {"piles/1", "piles/2", "piles/4", "piles/8", "piles/100", "quadrupeds/10",
                           "quadrupeds/100", "ragdolls/10"})
    if (what.name == name) return true;
  return false;
}

const bool kRegistered = [] {
  static const std::vector<SceneCase> cases = scene_cases();
  for (const SceneCase& what : cases)
    for (const StepperKind& kind : stepper_kinds())
      if (kind.takes(what.model) && is_compared(what, kind.name))
        benchmark::RegisterBenchmark(("Scene/" + what.name + "/" + kind.name).c_str(),
                                     [&](benchmark::State& state) { run(state, what, kind); })
            ->Unit(benchmark::kMicrosecond)
            ->Iterations(what.ticks);
  for (const SceneCase& what : cases)
    for (const int threads : {1, 2})
      if (is_of_islands(what))
        benchmark::RegisterBenchmark(
            ("Threads/" + what.name + "/" + std::to_string(threads)).c_str(),
            [&what, threads](benchmark::State& state) { run_with_threads(state, what, threads); })
            ->Unit(benchmark::kMicrosecond)
            ->UseRealTime()
            ->Iterations(what.ticks);
  return true;
}();

}  // namespace
}  // namespace visum::bench
