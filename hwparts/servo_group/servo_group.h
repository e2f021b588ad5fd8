// The part of a group of servos: ports in front of drives. Kind `servo_group`, and, with another layout of
// the ports, `amtec_arm`.
//
// Commands:
// - Desired values and maximum speeds hold until they are written again. A drive follows them on a trapezoid;
//   one with `control: velocity` is commanded by `Desired Speed`, which it takes on a ramp and keeps.
// - Reset, Home, Halt act when their number changes, in this order; the last number seen starts at 0.
// - A fault of one drive stops them all, each on its ramp. Desired values, Home and Halt's motion are then
// ignored.
// - Reset clears what may be cleared (drive/supervision.h). If the group was stopped by a fault or by Halt,
// each drive
//   then stands where it is until its own desired value is another one than at the tick of the Reset: an old
//   command, or one written together with the Reset, moves nothing. After Home it is the same, from where
//   home is.
// - Execution Enable 0 stops on a ramp and keeps standing; 1 again goes on to the desired values.
// - A field bus (powercube::ModuleBus) commands the same drives. Who spoke last to a drive moves it: after a
// command over
//   the bus, the ports again as soon as the drive's desired value becomes another one. What the bus moves is
//   not stopped by the fault of another drive.
// - A lost controller: `stop` is a fault (COMM_ERROR) of all drives; `hold` leaves the last values in force.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hwparts/drive/drive.h"
#include "hwparts/part.h"
#include "hwparts/powercube/module_bus.h"
#include "hwparts/servo_group/drive_list.h"
#include "hwparts/servo_group/group_faults.h"
#include "hwparts/servo_group/part_options.h"
#include "hwparts/servo_group/part_state.h"
#include "hwparts/servo_group/port_layout.h"

namespace visum::servo_group {

class ServoGroup : public hwparts::Part {
 public:
  ServoGroup(const hwparts::PartContext& context, const std::string& kind, const DriveList& drives,
             const PartOptions& options, PortLayout layout);

  const protocol::PartDescription& description() const override { return description_; }
  std::span<const std::size_t> joints() const override { return joints_; }
  std::optional<std::string> refuse(std::span<const double> inputs) const override;
  void latch(std::span<const double> inputs) override;
  void act(std::span<const double> inputs, std::span<const hwparts::JointSample> samples,
           std::span<hwparts::JointDrive> drives) override;
  void publish(std::span<const hwparts::JointSample> samples, std::span<double> outputs) override;
  void following_errors(std::span<double> errors) const override;
  void controller_lost() override;
  void reset() override;
  std::vector<protocol::Parameter> parameters() const override;
  std::optional<std::string> set_parameter(const std::string& name,
                                           const protocol::ParameterValue& value) override;
  std::span<const std::byte> read_blackboard(std::size_t index) const override;
  bool has(hwparts::FaultTarget target) const override { return target != hwparts::FaultTarget::kSensor; }
  std::optional<std::string> refuse_fault(const hwparts::Fault& fault) const override;
  void set_faults(std::span<const hwparts::ActiveFault> faults) override;
  powercube::ModuleBus* modules() override { return &modules_; }
  void save(hwparts::StateWriter& to) const override;
  void load(hwparts::StateReader& from) override;

 private:
  // A drive with its joints: a run of the part's joints and of its channels.
  struct Axis {
    drive::Drive drive;
    Run run;
  };
  // What changes, beside the drives.
  struct State {
    double reset = 0.0, home = 0.0, halt = 0.0;  // the counters as last seen
    bool enabled = true;
    OnControllerLost on_controller_lost = OnControllerLost::kStop;
    double supply_voltage = 0.0;  // V; reaches the drives unless the emergency stop is pressed
    bool emergency_stop = false;
    std::uint64_t changed = 0;
  };

  void apply_counters(std::span<const double> inputs);
  void interlock();
  double target(const Axis& axis, std::span<const double> inputs) const;  // module's coordinate, or its speed
  bool any(std::uint32_t bits) const;
  PartState part_state() const;
  std::optional<std::string> set_tuning(const std::string& name, double value);
  std::optional<std::string> set_supply(double volts);
  void supply_drives();
  double encoder_noise(std::size_t axis) const;

  PortLayout layout_;
  std::vector<std::size_t> joints_;
  double tick_s_;
  std::vector<Axis> axes_;
  powercube::ModuleBus modules_;
  State initial_;
  State state_;
  GroupFaults faults_;  // what acts; no state of the part
  std::uint64_t seed_;
  bool acted_ = false;  // between act() and publish()
  std::string identity_;
  protocol::PartDescription description_;
};

// The channels of kind `servo_group`: one block, in the order of the drives file.
std::vector<std::vector<Channel>> one_block(const DriveList& drives);
// Kind `servo_group`. Throws ConfigError.
std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context);

}  // namespace visum::servo_group
