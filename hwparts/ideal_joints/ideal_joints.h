// A part whose joints do what they are told: the kind `ideal_joints`. It has no motor, gear or fault, for
// robots whose drives are not known. Without the key `actuators` each joint approaches its desired position
// at a speed in proportion to the distance. With it, each joint has the ports of all modes (actuator.h), and
// one of them chooses its mode at run time. Speed and effort keep within the limits of the model. The
// simulation owns it; it lives on the tick's thread (part.h says which functions others may call). Only
// construction can fail.
#pragma once

#include <memory>
#include <vector>

#include "hwparts/ideal_joints/actuator.h"
#include "hwparts/part.h"

namespace visum::ideal_joints {

class IdealJoints : public hwparts::Part {
 public:
  explicit IdealJoints(const hwparts::PartContext& context);

  const protocol::PartDescription& description() const override { return description_; }
  std::span<const std::size_t> joints() const override { return joints_; }
  std::optional<std::string> refuse(std::span<const double> inputs) const override;
  void act(std::span<const double> inputs, std::span<const hwparts::JointSample> samples,
           std::span<hwparts::JointDrive> drives) override;
  void publish(std::span<const hwparts::JointSample> samples, std::span<double> outputs) override;
  void following_errors(std::span<double> errors) const override;
  // Joints with a position go on to it and stay there. With other modes they stand where they are.
  void controller_lost() override;
  // Without `actuators` a joint goes back to its desired position.
  void place(std::span<const std::size_t> moved, std::span<const hwparts::JointSample> samples) override;
  void reset() override;
  void save(hwparts::StateWriter& to) const override;
  void load(hwparts::StateReader& from) override;

 private:
  struct Joint {
    Limit limit;
    ActuatorInputs initial;
    ActuatorState state;
    ActuatorInputs now;   // as of the last act()
    double actual = 0.0;  // position, as of the last publish()
  };
  void add_ports(const hwparts::PartContext& context);
  // The inputs of joint i, from the part's vector.
  ActuatorInputs inputs_of(std::span<const double> inputs, std::size_t i) const;

  double tick_s_;
  bool switchable_;  // the scene gives `actuators`
  std::vector<Joint> all_;
  std::vector<std::size_t> joints_;
  protocol::PartDescription description_;
};

// Makes a part of this kind. Throws ConfigError.
std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context);
// There are no real ideal joints: throws std::runtime_error.
std::unique_ptr<hwparts::Part> make_real(const hwparts::PartContext& context, powercube::BusConnection& line,
                                         const hwparts::RealOptions& options);

}  // namespace visum::ideal_joints
