// The actuator of one ideal joint: position, velocity, effort, or impedance, which is a position with
// stiffness, damping and a feed-forward effort. Plain values and pure functions. Units: rad, rad/s and N·m,
// or m, m/s and N; [u] and [F] below.
#pragma once

#include <cstddef>
#include <optional>

#include "hwparts/joint.h"
#include "hwparts/state_archive.h"
#include "protocol/config/config.h"

namespace visum::ideal_joints {

// The number is the value of the port `Mode`.
enum class Mode { kPosition = 0, kVelocity = 1, kEffort = 2, kImpedance = 3 };
inline constexpr std::size_t kModes = 4;
inline constexpr const char* kModeNames[kModes] = {"position", "velocity", "effort", "impedance"};

// The bounds of the joint, from the model's <limit>.
struct Limit {
  double speed;   // [u]/s
  double effort;  // [F]
};

// How the joint starts, from the scene.
struct ActuatorOptions {
  Mode mode = Mode::kPosition;
  double stiffness = 0.0;  // [F]/[u]
  double damping = 0.0;    // [F]/([u]/s)
};

// The controller inputs of one joint.
struct Targets {
  double position = 0.0;
  double speed = 0.0;
  double effort = 0.0;
  bool operator==(const Targets&) const = default;
};
struct ActuatorInputs {
  Mode mode = Mode::kPosition;
  Targets targets;
  double stiffness = 0.0;
  double damping = 0.0;
};

// A mode that is new starts from where the joint is, and each target of it is held there until its port has
// another value than in the tick before the change. So an old target moves nothing.
struct ActuatorState {
  Mode mode = Mode::kPosition;
  Targets ports;  // as in the last tick
  Targets stale;  // the ports' values that are not followed
  Targets held;   // in their place
  bool holds_position = false;
  bool holds_speed = false;
  bool holds_effort = false;
  bool lost = false;    // the controller is gone since the last tick
  bool stands = false;  // it was lost in a mode without a position: the joint stands at held.position
};

// At rest, following the ports.
ActuatorState initial_state(const ActuatorInputs& inputs);

// One tick: takes a change of the mode, or the loss of the controller, and returns what to follow. After a
// loss, a joint with a position goes on to it, and any other stands where it is.
ActuatorInputs inputs_now(const ActuatorInputs& ports, const hwparts::JointSample& sample,
                          ActuatorState& state);

// The joint was put elsewhere: its mode goes on from there, and holds each target until its port changes.
void stand_at(const hwparts::JointSample& sample, ActuatorState& state);

// The effort law of this tick. `tick_s`: its length.
hwparts::JointDrive law(const ActuatorInputs& inputs, const Limit& limit, const hwparts::JointSample& sample,
                        double tick_s);

// Desired minus actual position; 0 in a mode without a position.
double following_error(const ActuatorInputs& inputs, double position);

// Reads `{mode: impedance, kp: 60, kd: 2}`; what it does not say is as in `otherwise`. Throws ConfigError.
ActuatorOptions read_actuator(const config::Node& node, const ActuatorOptions& otherwise);

void save(const ActuatorState& state, hwparts::StateWriter& to);
void load(ActuatorState& state, hwparts::StateReader& from);

}  // namespace visum::ideal_joints
