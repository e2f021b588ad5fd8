// A part that is a group of servos with real modules on a bus. It has the same ports as
// servo_group::ServoGroup, in the same order and with the same meaning, so that a controller cannot tell the
// two apart. It knows the modules only from their answers. Readings come as often as the bus allows, and
// commands go before readings.
//
// The gateway's process that stands in front of the hardware owns it, and calls it from one thread. Making it
// can fail (make() below); afterwards everything that fails is a fault of a module.
//
// It differs from the virtual part where it must:
// - `Execution Enable` starts as 0 unless an operator says otherwise, and desired values start where the
//   modules stand.
// - A module that does not answer, or that has suddenly become another one, has ERROR and COMM_ERROR, and the
//   others are stopped. When it answers again it is halted at once, and `Reset` takes it back.
// - A motion that another program on the bus has begun shows in the readings and is not undone.
// - It cannot be reset, saved or restored. Only simulated worlds can do that.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "hwparts/bus_group/bus_axis.h"
#include "hwparts/part.h"
#include "hwparts/powercube/asker.h"
#include "hwparts/servo_group/drive_list.h"
#include "hwparts/servo_group/part_options.h"
#include "hwparts/servo_group/port_layout.h"
#include "hwparts/servo_group/tuning.h"

namespace visum::bus_group {

class BusGroup : public hwparts::Part {
 public:
  // `found`: the survey's result, in the order of `drives`. The connection must outlive the part.
  BusGroup(const hwparts::PartContext& context, const std::string& kind, const servo_group::DriveList& drives,
           const std::vector<Found>& found, const hwparts::RealOptions& options,
           servo_group::PortLayout layout, powercube::BusConnection& line);

  const protocol::PartDescription& description() const override { return description_; }
  std::span<const std::size_t> joints() const override { return {}; }  // none of a world's
  std::optional<std::string> refuse(std::span<const double> inputs) const override;
  void act(std::span<const double> inputs, std::span<const hwparts::JointSample> samples,
           std::span<hwparts::JointDrive> drives) override;
  void publish(std::span<const hwparts::JointSample> samples, std::span<double> outputs) override;
  void following_errors(std::span<double>) const override {}
  void controller_lost() override;
  void reset() override {}
  std::vector<protocol::Parameter> parameters() const override;
  std::optional<std::string> set_parameter(const std::string& name,
                                           const protocol::ParameterValue& value) override;
  std::span<const std::byte> read_blackboard(std::size_t index) const override;
  void save(hwparts::StateWriter&) const override {}
  void load(hwparts::StateReader&) override {}
  void pump() override;
  void stand_down() override;

 private:
  struct Axis {
    BusAxis module;
    servo_group::Run run;
    drive::Tuning tuning;       // only the fields that a module has are used
    double ignored = 0.0;       // [u], this desired value is not followed, until it becomes another one
    bool held = true;           // `ignored` holds
    std::int64_t asked_ns = 0;  // while lost: when the module was last asked whether it answers again
  };

  // Carries out Reset, Home and Halt where their counters have changed.
  void apply_counters(std::span<const double> inputs);
  // Lets every axis stand until its desired value becomes another one.
  void hold_all(std::span<const double> inputs);
  // The leave to move that the group has now. kWait: begins no motion and stops none.
  enum class Leave { kStand, kWait, kMove };
  Leave leave() const;
  // Turns one axis' inputs into wishes.
  void drive(Axis& axis, std::span<const double> inputs, Leave leave);
  std::optional<std::string> set_tuning(Axis& axis, const servo_group::TuningField& field, double value);
  bool any(std::uint32_t bits) const;
  bool settling() const;
  servo_group::PartState part_state() const;
  // Sends the next request of one axis, by turns. False: no axis has one that can be sent now.
  bool ask_one(bool wishes_only);
  void ask(Axis& axis);
  // Marks all modules as lost, since the bus's device is gone.
  void lose_all();
  // Broadcasts a life sign when it is time.
  void serve_watchdog();

  double tick_s_;
  servo_group::PortLayout layout_;
  std::vector<Axis> axes_;
  powercube::Asker asker_;
  std::size_t turn_ = 0;  // the axis that is asked next
  bool watchdog_;
  std::int64_t served_ns_ = 0;

  double reset_ = 0.0, home_ = 0.0, halt_ = 0.0;  // the counters as last seen
  bool enabled_ = false;
  bool controller_lost_ = false;  // until Reset
  servo_group::OnControllerLost on_controller_lost_;
  std::uint64_t changed_ = 0;
  std::string identity_;
  protocol::PartDescription description_;
};

// A kind of part for real modules: the check of its drives file, and the channels of its drives.
struct Kind {
  const char* name;
  void (*check)(const hwparts::PartContext&, const servo_group::DriveList&);
  std::vector<std::vector<servo_group::Channel>> (*blocks)(const servo_group::DriveList&);
};

// Surveys the bus and makes the part. Throws ConfigError, and std::runtime_error where the modules on the bus
// are not this part's.
std::unique_ptr<hwparts::Part> make(const Kind& kind, const hwparts::PartContext& context,
                                    powercube::BusConnection& line, const hwparts::RealOptions& options);
// The same for the kind `servo_group`.
std::unique_ptr<hwparts::Part> make_servo_group(const hwparts::PartContext& context,
                                                powercube::BusConnection& line,
                                                const hwparts::RealOptions& options);

}  // namespace visum::bus_group
