// A part whose joints go where they are told: the kind `ideal_joints`. It has no motor, gear or fault, for
// robots whose drives are not known. Each joint approaches its desired position at a speed in proportion to
// the distance, within the speed and effort limits of the model. The simulation owns it; it lives on the
// tick's thread (part.h says which functions others may call). Only construction can fail.
#pragma once

#include <memory>
#include <vector>

#include "hwparts/part.h"

namespace visum::ideal_joints {

class IdealJoints : public hwparts::Part {
 public:
  explicit IdealJoints(const hwparts::PartContext& context);

  const protocol::PartDescription& description() const override { return description_; }
  std::span<const std::size_t> joints() const override { return joints_; }
  std::optional<std::string> refuse(std::span<const double>) const override { return std::nullopt; }
  void act(std::span<const double> inputs, std::span<const hwparts::JointSample> samples,
           std::span<hwparts::JointDrive> drives) override;
  void publish(std::span<const hwparts::JointSample> samples, std::span<double> outputs) override;
  void following_errors(std::span<double> errors) const override;
  // The joints go on to their desired positions and stay there.
  void controller_lost() override {}
  void reset() override;
  void save(hwparts::StateWriter& to) const override;
  void load(hwparts::StateReader& from) override;

 private:
  struct Limit {
    double speed;   // rad/s or m/s
    double effort;  // N·m or N
  };
  std::vector<Limit> limits_;
  std::vector<std::size_t> joints_;
  std::vector<double> desired_;  // of the last act()
  std::vector<double> actual_;   // of the last publish()
  std::vector<double> initial_;
  protocol::PartDescription description_;
};

// Makes a part of this kind. Throws ConfigError.
std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context);
// There are no real ideal joints: throws std::runtime_error.
std::unique_ptr<hwparts::Part> make_real(const hwparts::PartContext& context, powercube::BusConnection& line,
                                         const hwparts::RealOptions& options);

}  // namespace visum::ideal_joints
