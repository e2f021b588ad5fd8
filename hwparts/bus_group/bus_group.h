// The part of a group of servos whose drives are real modules on a bus: the same ports, in the same order,
// with the same meaning as servo_group::ServoGroup's, so that a controller cannot tell the two apart. It
// knows the modules from what they answer and nothing else: readings come as often as the bus lets them,
// commands go before readings.
//
// What is different from the virtual part, since it must be:
// - `Execution Enable` starts as 0 unless an operator says otherwise, and desired values as the modules
// stand.
// - A module that does not answer, or that is another one all of a sudden, has ERROR and COMM_ERROR, and the
//   others are stopped. When it answers again it is halted at once, and `Reset` takes it back.
// - What is no motion of its own (a program beside it on the bus) shows in the readings and is not undone.
// - It cannot be reset, saved or restored: that is what simulated worlds can do.
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
  // `found`: of the survey, in the order of `drives`. The line outlives the part.
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
    drive::Tuning tuning;       // what of it a module has
    double ignored = 0.0;       // [u], the desired value that is not followed: until it is another one
    bool held = true;           // `ignored` holds
    std::int64_t asked_ns = 0;  // while lost: when it was last asked whether it is there again
  };

  void apply_counters(std::span<const double> inputs);
  void hold_all(std::span<const double> inputs);
  enum class Leave { kStand, kWait, kMove };  // to move; kWait: begins nothing, stops nothing
  Leave leave() const;
  void drive(Axis& axis, std::span<const double> inputs, Leave leave);
  std::optional<std::string> set_tuning(Axis& axis, const servo_group::TuningField& field, double value);
  bool any(std::uint32_t bits) const;
  bool settling() const;
  servo_group::PartState part_state() const;
  bool ask_one(bool wishes_only);
  void ask(Axis& axis);
  void lose_all();
  void serve_watchdog();

  double tick_s_;
  servo_group::PortLayout layout_;
  std::vector<Axis> axes_;
  powercube::Asker asker_;
  std::size_t turn_ = 0;  // whose turn it is to be asked
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

// Which channels a kind's drives have, and what its configuration must hold.
struct Kind {
  const char* name;
  void (*check)(const hwparts::PartContext&, const servo_group::DriveList&);
  std::vector<std::vector<servo_group::Channel>> (*blocks)(const servo_group::DriveList&);
};

// Surveys the line and makes the part. Throws ConfigError, and std::runtime_error where the bus is not this
// part's.
std::unique_ptr<hwparts::Part> make(const Kind& kind, const hwparts::PartContext& context,
                                    powercube::BusConnection& line, const hwparts::RealOptions& options);
// Kind `servo_group`.
std::unique_ptr<hwparts::Part> make_servo_group(const hwparts::PartContext& context,
                                                powercube::BusConnection& line,
                                                const hwparts::RealOptions& options);

}  // namespace visum::bus_group
