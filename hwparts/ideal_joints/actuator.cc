#include "hwparts/ideal_joints/actuator.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace visum::ideal_joints {
namespace {

using hwparts::JointDrive;
using hwparts::JointSample;

constexpr double kGainPerS = 20.0;      // mode position: speed for each unit of distance
constexpr double kStill = 1e-3;         // [u]/s: a slower joint counts as standing when its mode changes
constexpr double kSoftest = 1e-12;      // [F]/([u]/s): an impedance below it is a pure effort
constexpr double kMostStiffness = 1e7;  // [F]/[u], of the scene's gains
constexpr double kMostDamping = 1e6;    // [F]/([u]/s)

void start_mode(Mode mode, const JointSample& sample, ActuatorState& state) {
  const bool still = mode == Mode::kImpedance || std::abs(sample.velocity) < kStill;
  state.mode = mode;
  state.stale = state.ports;
  state.held = {sample.position, still ? 0.0 : sample.velocity, sample.effort};
  state.holds_position = state.holds_speed = state.holds_effort = true;
  state.stands = false;
}

void lose(const JointSample& sample, ActuatorState& state) {
  state.lost = false;
  state.stale.speed = state.ports.speed;
  state.held.speed = 0.0;
  state.holds_speed = true;
  state.stands = state.mode == Mode::kVelocity || state.mode == Mode::kEffort;
  if (!state.stands) return;
  state.stale = state.ports;
  state.held.position = sample.position;
}

// The port's value, or the held one as long as the port has the value that is not followed.
double followed(double port, double stale, double held, bool& holds) {
  holds = holds && port == stale;
  return holds ? held : port;
}

JointDrive position_law(double desired, const Limit& limit, const JointSample& sample) {
  const double speed = kGainPerS * (desired - sample.position);
  return {std::clamp(speed, -limit.speed, limit.speed), 0.0, limit.effort, 0.0};
}

// All effort towards the largest speed, so that the joint gets no faster.
JointDrive effort_law(double desired, const Limit& limit) {
  const double effort = std::clamp(desired, -limit.effort, limit.effort);
  return {effort < 0.0 ? -limit.speed : limit.speed, 0.0, std::abs(effort), 0.0};
}

// effort = kp (q* - q⁺) + kd (v* - v⁺) + f, with position and speed at the END of the tick, q⁺ = q + h v⁺:
// stable at any gains. Written as (t - v⁺)/c with 1/c = kp h + kd.
JointDrive impedance_law(const ActuatorInputs& inputs, const Limit& limit, const JointSample& sample,
                         double tick_s) {
  const auto& [position, speed, effort] = inputs.targets;
  const double slope = inputs.stiffness * tick_s + inputs.damping;
  if (slope < kSoftest) return effort_law(effort, limit);
  const double at_rest = inputs.stiffness * (position - sample.position) + inputs.damping * speed + effort;
  const double free_speed = at_rest / slope;
  // Too fast already, and the law pushes on: only the largest speed is kept.
  const bool too_fast =
      std::abs(sample.velocity) >= limit.speed && (free_speed - sample.velocity) * sample.velocity > 0.0;
  if (too_fast) return {std::copysign(limit.speed, sample.velocity), 0.0, limit.effort, 0.0};
  return {free_speed, 1.0 / slope, limit.effort, 0.0};
}

}  // namespace

ActuatorState initial_state(const ActuatorInputs& inputs) {
  ActuatorState state;
  state.mode = inputs.mode;
  state.ports = inputs.targets;
  return state;
}

ActuatorInputs inputs_now(const ActuatorInputs& ports, const JointSample& sample, ActuatorState& state) {
  if (ports.mode != state.mode) start_mode(ports.mode, sample, state);
  if (state.lost) lose(sample, state);
  const double own = state.mode == Mode::kEffort ? ports.targets.effort : ports.targets.speed;
  const double stale = state.mode == Mode::kEffort ? state.stale.effort : state.stale.speed;
  state.stands = state.stands && own == stale;
  state.ports = ports.targets;
  ActuatorInputs now = ports;
  now.targets = {
      followed(ports.targets.position, state.stale.position, state.held.position, state.holds_position),
      followed(ports.targets.speed, state.stale.speed, state.held.speed, state.holds_speed),
      followed(ports.targets.effort, state.stale.effort, state.held.effort, state.holds_effort)};
  if (!state.stands) return now;
  now.mode = Mode::kPosition;
  now.targets.position = state.held.position;
  return now;
}

void stand_at(const JointSample& sample, ActuatorState& state) {
  start_mode(state.mode, {sample.position, 0.0, 0.0}, state);
}

JointDrive law(const ActuatorInputs& inputs, const Limit& limit, const JointSample& sample, double tick_s) {
  switch (inputs.mode) {
    case Mode::kPosition:
      return position_law(inputs.targets.position, limit, sample);
    case Mode::kVelocity:
      return {std::clamp(inputs.targets.speed, -limit.speed, limit.speed), 0.0, limit.effort, 0.0};
    case Mode::kEffort:
      return effort_law(inputs.targets.effort, limit);
    case Mode::kImpedance:
      return impedance_law(inputs, limit, sample, tick_s);
  }
  return {};
}

double following_error(const ActuatorInputs& inputs, double position) {
  const bool has_position = inputs.mode == Mode::kPosition || inputs.mode == Mode::kImpedance;
  return has_position ? inputs.targets.position - position : 0.0;
}

ActuatorOptions read_actuator(const config::Node& node, const ActuatorOptions& otherwise) {
  node.allow_only({"mode", "kp", "kd"});
  ActuatorOptions options = otherwise;
  if (const auto mode = node.find("mode")) {
    const std::vector<std::string> names(std::begin(kModeNames), std::end(kModeNames));
    options.mode = static_cast<Mode>(std::ranges::find(names, mode->one_of(names)) - names.begin());
  }
  options.stiffness = node.number_or("kp", options.stiffness, {0.0, kMostStiffness});
  options.damping = node.number_or("kd", options.damping, {0.0, kMostDamping});
  if (options.mode == Mode::kImpedance && options.stiffness == 0.0 && options.damping == 0.0)
    node.fail("mode: impedance needs kp (stiffness) or kd (damping) above 0; mode: effort needs neither");
  return options;
}

void save(const ActuatorState& state, hwparts::StateWriter& to) {
  to.put(state.mode);
  for (const Targets& targets : {state.ports, state.stale, state.held}) {
    to.put(targets.position);
    to.put(targets.speed);
    to.put(targets.effort);
  }
  for (const bool flag :
       {state.holds_position, state.holds_speed, state.holds_effort, state.lost, state.stands})
    to.put(flag);
}

void load(ActuatorState& state, hwparts::StateReader& from) {
  from.get(state.mode);
  for (Targets* targets : {&state.ports, &state.stale, &state.held}) {
    from.get(targets->position);
    from.get(targets->speed);
    from.get(targets->effort);
  }
  for (bool* flag :
       {&state.holds_position, &state.holds_speed, &state.holds_effort, &state.lost, &state.stands})
    from.get(*flag);
}

}  // namespace visum::ideal_joints
