#include "hwparts/ideal_joints/ideal_joints.h"

#include <algorithm>
#include <stdexcept>

namespace visum::ideal_joints {
namespace {

using hwparts::JointInfo;
using protocol::Port;

constexpr double kGainPerS = 20.0;      // speed for each unit of distance
constexpr double kUnlimited = 1000.0;   // rad or m, range of the ports of a joint without stops
constexpr double kDefaultSpeed = 3.0;   // rad/s or m/s, where the model gives none
constexpr double kDefaultEffort = 1e4;  // N·m or N, where the model gives none
constexpr double kPortEffort = 1e9;     // range of the effort ports

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

}  // namespace

IdealJoints::IdealJoints(const hwparts::PartContext& context) {
  context.config.allow_only({"name", "kind", "model", "joints"});
  if (context.joints.empty())
    context.config.fail("drives no joint: name 'joints' or a 'model' that has some");
  description_.name = context.name;
  description_.kind = "ideal_joints";
  auto& outputs = description_.sensor_outputs;
  for (std::size_t i = 0; i < context.joints.size(); ++i) {
    const JointInfo& joint = context.joints[i];
    joints_.push_back(i);
    limits_.push_back({joint.maximum_speed > 0 ? joint.maximum_speed : kDefaultSpeed,
                       joint.maximum_effort > 0 ? joint.maximum_effort : kDefaultEffort});
    initial_.push_back(joint.initial_position);
    description_.controller_inputs.push_back(
        position_port(joint.prismatic ? "Desired Position" : "Desired Angle", i + 1, joint));
    outputs.push_back(actual_port(i + 1, joint));
  }
  for (std::size_t i = 0; i < context.joints.size(); ++i)
    outputs.push_back({"Actual Speed " + std::to_string(i + 1), context.joints[i].prismatic ? "m/s" : "rad/s",
                       -kUnlimited, kUnlimited, 0.0, "Actual Speed"});
  for (std::size_t i = 0; i < context.joints.size(); ++i)
    outputs.push_back({"Actual Effort " + std::to_string(i + 1), context.joints[i].prismatic ? "N" : "Nm",
                       -kPortEffort, kPortEffort, 0.0, "Actual Effort"});
  IdealJoints::reset();
}

void IdealJoints::act(std::span<const double> inputs, std::span<const hwparts::JointSample> samples,
                      std::span<hwparts::JointDrive> drives) {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    desired_[i] = inputs[i];
    const double speed = kGainPerS * (inputs[i] - samples[i].position);
    drives[i] = {std::clamp(speed, -limits_[i].speed, limits_[i].speed), 0.0, limits_[i].effort, 0.0};
  }
}

void IdealJoints::publish(std::span<const hwparts::JointSample> samples, std::span<double> outputs) {
  const std::size_t n = joints_.size();
  for (std::size_t i = 0; i < n; ++i) {
    actual_[i] = samples[i].position;
    outputs[i] = samples[i].position;
    outputs[n + i] = samples[i].velocity;
    outputs[2 * n + i] = samples[i].effort;
  }
}

void IdealJoints::following_errors(std::span<double> errors) const {
  for (std::size_t i = 0; i < joints_.size(); ++i) errors[i] = desired_[i] - actual_[i];
}

void IdealJoints::reset() {
  desired_ = initial_;
  actual_ = initial_;
}

void IdealJoints::save(hwparts::StateWriter& to) const {
  to.put(desired_);
  to.put(actual_);
}

void IdealJoints::load(hwparts::StateReader& from) {
  for (double& value : desired_) from.get(value);
  for (double& value : actual_) from.get(value);
}

std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context) {
  return std::make_unique<IdealJoints>(context);
}

std::unique_ptr<hwparts::Part> make_real(const hwparts::PartContext&, powercube::BusConnection&,
                                         const hwparts::RealOptions&) {
  throw std::runtime_error("parts of the kind 'ideal_joints' are simulated only");
}

}  // namespace visum::ideal_joints
