// A part that is a group of servos: ports in front of drives. It is the kind `servo_group` and, with another
// layout of the ports, `amtec_arm`. The simulation owns it; it lives on the tick's thread (part.h says which
// functions others may call). Only construction can fail.
//
// Commands:
// - Desired values and maximum speeds hold until they are written again. A drive follows them on a trapezoid.
//   A drive with `control: velocity` has `Desired Speed` instead, which it reaches on a ramp and keeps.
// - Reset, Home and Halt act when their number changes, in this order. The last number seen starts at 0.
// - A fault of one drive stops all drives, each on its ramp. Desired values, and Home, are then ignored.
// - Reset clears the faults that may be cleared (drive/supervision.h). If a fault or Halt had stopped the
//   group, each drive then stands where it is until its own desired value differs from the one at the tick of
//   the Reset. So an old command, or one written together with the Reset, moves nothing. After Home it is the
//   same, at the home position.
// - Execution Enable 0 stops the drives on a ramp and keeps them standing. 1 lets them go on to the desired
//   values.
// - A field bus (powercube::ModuleBus) commands the same drives. The last command to a drive holds: after a
//   command over the bus, the ports command the drive again as soon as its desired value becomes another one.
//   The fault of another drive does not stop a drive that the bus moves.
// - A trajectory on the blackboard `Trajectory` (trajectory.h) does as well: the drives go along it in steps,
//   as a field bus would command them. It ends at once when a drive gets another command, stops or may not
//   move; the other drives then stop, too.
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
#include "hwparts/servo_group/trajectory.h"

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
  void place(std::span<const std::size_t> moved, std::span<const hwparts::JointSample> samples) override;
  void reset() override;
  std::vector<protocol::Parameter> parameters() const override;
  std::optional<std::string> set_parameter(const std::string& name,
                                           const protocol::ParameterValue& value) override;
  std::span<const std::byte> read_blackboard(std::size_t index) const override;
  std::optional<std::string> write_blackboard(std::size_t index, std::uint64_t offset,
                                              std::span<const std::byte> data) override;
  bool has(hwparts::FaultTarget target) const override { return target != hwparts::FaultTarget::kSensor; }
  std::optional<std::string> refuse_fault(const hwparts::Fault& fault) const override;
  void set_faults(std::span<const hwparts::ActiveFault> faults) override;
  std::uint64_t trips() const override { return trips_; }
  std::string trip_text(std::uint64_t since = 0) const override;
  powercube::ModuleBus* modules() override { return &modules_; }
  void save(hwparts::StateWriter& to) const override;
  void load(hwparts::StateReader& from) override;

 private:
  // A drive with its run of the part's joints and channels.
  struct Axis {
    drive::Drive drive;
    Run run;
    std::string joint;          // its name; of the first, where it moves several
    double step = 0.0;          // [u], where the trajectory's last step goes
    std::uint64_t tripped = 0;  // number of its last trip, among all of the group
  };
  // The changing state apart from drives and modules.
  struct State {
    double reset = 0.0, home = 0.0, halt = 0.0;  // the counters as last seen
    bool enabled = true;
    OnControllerLost on_controller_lost = OnControllerLost::kStop;
    double supply_voltage = 0.0;  // V; 0 reaches the drives while the emergency stop is pressed
    bool emergency_stop = false;
    std::uint64_t changed = 0;
  };

  // Carries out Reset, Home and Halt where their counters have changed.
  void apply_counters(std::span<const double> inputs);
  // While any drive is stopped by a fault or Halt: holds all drives. After a fault, also ends homing that the
  // ports asked for.
  void interlock();
  // Sends the drives one tick further along the trajectory, or ends it.
  void follow_trajectory();
  // True while the axis does what the trajectory told it last.
  bool follows_trajectory(const Axis& axis) const;
  void end_trajectory();
  // The sum of the trajectory's targets for the joints of a drive: the module's coordinate.
  double trajectory_target(const Axis& axis) const;
  // The desired value of a drive, in the module's coordinate: a position, or a speed.
  double target(const Axis& axis, std::span<const double> inputs) const;
  // True where any drive has any of `bits` latched.
  bool any(std::uint32_t bits) const;
  PartState part_state() const;
  std::optional<std::string> set_tuning(const std::string& name, double value);
  std::optional<std::string> set_supply(double volts);
  // Gives the drives the voltage that emergency stop and faults leave.
  void supply_drives();
  // [u], for this tick's reading. Follows from seed, tick and drive alone, so that a replay has the same.
  double encoder_noise(std::size_t axis) const;

  PortLayout layout_;
  std::vector<std::size_t> joints_;
  double tick_s_;
  std::vector<Axis> axes_;
  powercube::ModuleBus modules_;
  State initial_;
  State state_;
  Trajectory trajectory_;
  GroupFaults faults_;  // those that act now; the simulation keeps their list, so they are no state here
  std::uint64_t seed_;
  bool acted_ = false;       // between act() and publish()
  std::uint64_t trips_ = 0;  // since construction; no state
  std::string identity_;
  protocol::PartDescription description_;
};

// The channels of the kind `servo_group`: one block, in the order of the drives file.
std::vector<std::vector<Channel>> one_block(const DriveList& drives);
// Makes a part of the kind `servo_group`. Throws ConfigError.
std::unique_ptr<hwparts::Part> make(const hwparts::PartContext& context);

}  // namespace visum::servo_group
