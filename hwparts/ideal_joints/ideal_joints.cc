#include "hwparts/ideal_joints/ideal_joints.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "protocol/config/unknown_name.h"

namespace visum::ideal_joints {
namespace {

using config::Node;
using hwparts::JointInfo;
using hwparts::PartContext;
using protocol::Port;

constexpr double kUnlimited = 1000.0;    // rad or m, range of the ports of a joint without stops
constexpr double kDefaultSpeed = 3.0;    // rad/s or m/s, where the model gives none
constexpr double kDefaultEffort = 1e4;   // N·m or N, where the model gives none
constexpr double kPortEffort = 1e9;      // range of the effort ports
constexpr double kPortStiffness = 1e7;   // N·m/rad or N/m
constexpr double kPortDamping = 1e6;     // N·m·s/rad or N·s/m
constexpr std::size_t kInputGroups = 6;  // of a switchable part: position, speed, effort, kp, kd, mode

Port position_port(const std::string& group, std::size_t number, const JointInfo& joint) {
  const bool limited = joint.lower <= joint.upper;
  return {group + " " + std::to_string(number),
          joint.prismatic ? "m" : "rad",
          limited ? joint.lower : -kUnlimited,
          limited ? joint.upper : kUnlimited,
          joint.initial_position,
          group};
}

// Sensor ports are wider than the stops, which give way a little.
Port actual_port(std::size_t number, const JointInfo& joint) {
  Port port = position_port(joint.prismatic ? "Actual Position" : "Actual Angle", number, joint);
  const double width = port.maximum - port.minimum;
  port.minimum -= width;
  port.maximum += width;
  return port;
}

// One port for each joint; a hinge's unit and a slider's.
void add_group(std::vector<Port>& ports, const PartContext& context, const char* group, const char* hinge,
               const char* slider, double minimum, double maximum) {
  for (std::size_t i = 0; i < context.joints.size(); ++i)
    ports.push_back({group + (" " + std::to_string(i + 1)), context.joints[i].prismatic ? slider : hinge,
                     minimum, maximum, 0.0, group});
}

Limit limit_of(const JointInfo& joint) {
  return {joint.maximum_speed > 0 ? joint.maximum_speed : kDefaultSpeed,
          joint.maximum_effort > 0 ? joint.maximum_effort : kDefaultEffort};
}

// The joints' options, from `actuators: {each: {...}, elbow: {...}}`.
std::vector<ActuatorOptions> read_actuators(const Node& node, const PartContext& context) {
  if (node.kind() != Node::Kind::kMap) node.fail("must be a map of joints, or of 'each' for all of them");
  std::vector<std::string> names;
  for (const JointInfo& joint : context.joints) names.push_back(joint.name);
  for (const std::string& key : node.keys())
    if (key != "each" && std::ranges::find(names, key) == names.end())
      node.get(key).fail(config::unknown_name("joint of this part", key, names));
  ActuatorOptions each;
  if (const auto given = node.find("each")) each = read_actuator(*given, {});
  std::vector<ActuatorOptions> options;
  for (const std::string& name : names) {
    const auto given = node.find(name);
    options.push_back(given ? read_actuator(*given, each) : each);
  }
  return options;
}

}  // namespace

IdealJoints::IdealJoints(const PartContext& context) : tick_s_(context.tick_s) {
  context.config.allow_only({"name", "kind", "model", "joints", "actuators"});
  if (context.joints.empty())
    context.config.fail("drives no joint: name 'joints' or a 'model' that has some");
  const auto actuators = context.config.find("actuators");
  switchable_ = actuators.has_value();
  std::vector<ActuatorOptions> options(context.joints.size());
  if (actuators) options = read_actuators(*actuators, context);
  for (std::size_t i = 0; i < context.joints.size(); ++i) {
    joints_.push_back(i);
    Joint joint{limit_of(context.joints[i]), {}, {}, {}};
    joint.initial = {options[i].mode,
                     {context.joints[i].initial_position, 0.0, 0.0},
                     options[i].stiffness,
                     options[i].damping};
    all_.push_back(joint);
  }
  description_.name = context.name;
  description_.kind = "ideal_joints";
  add_ports(context);
  IdealJoints::reset();
}

void IdealJoints::add_ports(const PartContext& context) {
  auto& inputs = description_.controller_inputs;
  auto& outputs = description_.sensor_outputs;
  const std::size_t n = all_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const JointInfo& joint = context.joints[i];
    inputs.push_back(position_port(joint.prismatic ? "Desired Position" : "Desired Angle", i + 1, joint));
    outputs.push_back(actual_port(i + 1, joint));
  }
  add_group(outputs, context, "Actual Speed", "rad/s", "m/s", -kUnlimited, kUnlimited);
  add_group(outputs, context, "Actual Effort", "Nm", "N", -kPortEffort, kPortEffort);
  if (!switchable_) return;
  add_group(inputs, context, "Desired Speed", "rad/s", "m/s", -kUnlimited, kUnlimited);
  add_group(inputs, context, "Desired Effort", "Nm", "N", -kPortEffort, kPortEffort);
  add_group(inputs, context, "Stiffness", "Nm/rad", "N/m", 0.0, kPortStiffness);
  add_group(inputs, context, "Damping", "Nms/rad", "Ns/m", 0.0, kPortDamping);
  add_group(inputs, context, "Mode", "", "", 0.0, static_cast<double>(kModes - 1));
  for (std::size_t i = 0; i < n; ++i) {
    inputs[3 * n + i].initial = all_[i].initial.stiffness;
    inputs[4 * n + i].initial = all_[i].initial.damping;
    Port& mode = inputs[5 * n + i];
    mode.initial = static_cast<double>(all_[i].initial.mode);
    for (std::size_t m = 0; m < kModes; ++m)
      mode.values.push_back({static_cast<std::int64_t>(m), kModeNames[m]});
  }
}

ActuatorInputs IdealJoints::inputs_of(std::span<const double> inputs, std::size_t i) const {
  if (!switchable_) return {Mode::kPosition, {inputs[i], 0.0, 0.0}, 0.0, 0.0};
  const std::size_t n = all_.size();
  return {static_cast<Mode>(static_cast<int>(inputs[5 * n + i])),
          {inputs[i], inputs[n + i], inputs[2 * n + i]},
          inputs[3 * n + i],
          inputs[4 * n + i]};
}

std::optional<std::string> IdealJoints::refuse(std::span<const double> inputs) const {
  if (!switchable_) return std::nullopt;
  for (std::size_t i = (kInputGroups - 1) * all_.size(); i < inputs.size(); ++i)
    if (inputs[i] != std::floor(inputs[i]))
      return description_.controller_inputs[i].name +
             " takes whole numbers only: 0 position, 1 velocity, 2 effort, 3 impedance";
  return std::nullopt;
}

void IdealJoints::act(std::span<const double> inputs, std::span<const hwparts::JointSample> samples,
                      std::span<hwparts::JointDrive> drives) {
  for (std::size_t i = 0; i < all_.size(); ++i) {
    Joint& joint = all_[i];
    joint.now = inputs_of(inputs, i);
    if (switchable_) joint.now = inputs_now(joint.now, samples[i], joint.state);
    drives[i] = law(joint.now, joint.limit, samples[i], tick_s_);
  }
}

void IdealJoints::publish(std::span<const hwparts::JointSample> samples, std::span<double> outputs) {
  const std::size_t n = all_.size();
  for (std::size_t i = 0; i < n; ++i) {
    all_[i].actual = samples[i].position;
    outputs[i] = samples[i].position;
    outputs[n + i] = samples[i].velocity;
    outputs[2 * n + i] = samples[i].effort;
  }
}

void IdealJoints::following_errors(std::span<double> errors) const {
  for (std::size_t i = 0; i < all_.size(); ++i) errors[i] = following_error(all_[i].now, all_[i].actual);
}

void IdealJoints::controller_lost() {
  if (!switchable_) return;
  for (Joint& joint : all_) joint.state.lost = true;
}

void IdealJoints::place(std::span<const std::size_t> moved, std::span<const hwparts::JointSample> samples) {
  for (const std::size_t i : moved) {
    all_[i].actual = samples[i].position;
    if (switchable_) stand_at(samples[i], all_[i].state);
  }
}

void IdealJoints::reset() {
  for (Joint& joint : all_) {
    joint.now = joint.initial;
    joint.actual = joint.initial.targets.position;
    joint.state = initial_state(joint.initial);
  }
}

void IdealJoints::save(hwparts::StateWriter& to) const {
  for (const Joint& joint : all_) to.put(joint.now.targets.position);
  for (const Joint& joint : all_) to.put(joint.actual);
  if (!switchable_) return;
  for (const Joint& joint : all_) {
    to.put(joint.now.mode);
    ideal_joints::save(joint.state, to);
  }
}

void IdealJoints::load(hwparts::StateReader& from) {
  for (Joint& joint : all_) from.get(joint.now.targets.position);
  for (Joint& joint : all_) from.get(joint.actual);
  if (!switchable_) return;
  for (Joint& joint : all_) {
    from.get(joint.now.mode);
    ideal_joints::load(joint.state, from);
  }
}

std::unique_ptr<hwparts::Part> make(const PartContext& context) {
  return std::make_unique<IdealJoints>(context);
}

std::unique_ptr<hwparts::Part> make_real(const PartContext&, powercube::BusConnection&,
                                         const hwparts::RealOptions&) {
  throw std::runtime_error("parts of the kind 'ideal_joints' are simulated only");
}

}  // namespace visum::ideal_joints
