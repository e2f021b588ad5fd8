// A hardware part: one named set of ports in front of drives or sensors, virtual or real. It knows no world
// and no socket. The simulation (or the process in front of real hardware) owns its parts.
//
// Order of calls:
//   construction       may throw ConfigError
//   per tick, on the tick's thread       act(), and after the engines moved, publish()
//   between ticks, on the same thread    latch(), place(), reset(), set_parameter(), controller_lost(),
//   set_faults(),
//                                        save(), load()
//   any time, from any thread            description() and refuse(), whose results never change, and
//                                        refuse_now(), whose results do
// Nothing here allocates after construction, except description(), the parameter calls and refusals.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hwparts/fault_set.h"
#include "hwparts/joint.h"
#include "hwparts/state_archive.h"
#include "protocol/config/config.h"
#include "protocol/part_description.h"

namespace visum::powercube {
class BusConnection;
class ModuleBus;
}  // namespace visum::powercube

namespace visum::hwparts {

// A joint that the part drives, as the robot's model describes it.
struct JointInfo {
  std::string name;  // as in the URDF
  bool prismatic = false;
  double lower = 0.0;  // mechanical stops; lower > upper: the joint has none
  double upper = 0.0;
  double initial_position = 0.0;
  double maximum_speed = 0.0;   // rad/s or m/s; 0: the model gives none
  double maximum_effort = 0.0;  // N·m or N; 0: the model gives none
  // The engine moves the joint in a tick by the mean of its speeds before and after; otherwise by the one
  // after.
  bool moves_by_mean_speed = false;
  double inertia = 0.0;  // kg·m² or kg: of its link alone, about or along the axis; 0: not known
};

struct PartContext {
  std::string name;               // in the scene
  config::Node config;            // the part's entry in the scene file
  std::vector<JointInfo> joints;  // the model's joints that the entry names, in the model's order
  double tick_s;                  // the tick's length
  std::uint64_t seed = 1;         // the scene's
};

class Part {
 public:
  virtual ~Part() = default;

  virtual const protocol::PartDescription& description() const = 0;  // parameters' values as at construction

  // The joints that the part drives: indices into PartContext::joints, in the order of the spans below.
  virtual std::span<const std::size_t> joints() const = 0;

  // The reason to refuse these controller inputs as a whole; nothing if they are good. Each is already finite
  // and inside its port's range.
  virtual std::optional<std::string> refuse(std::span<const double> controller_inputs) const = 0;

  // The reason why good inputs cannot take the place of those `before` just now; nothing if they can. For
  // parts that pass their inputs on to another program, which may be away.
  virtual std::optional<std::string> refuse_now(std::span<const double> /*before*/,
                                                std::span<const double> /*controller_inputs*/) const {
    return std::nullopt;
  }

  // The inputs that the next act() will have, as they are after a write. For parts that a field bus commands
  // as well, where it matters which command came last.
  virtual void latch(std::span<const double> /*controller_inputs*/) {}

  // One tick of the drives: turns inputs and the joints' samples into the efforts on the joints.
  virtual void act(std::span<const double> controller_inputs, std::span<const JointSample> samples,
                   std::span<JointDrive> drives) = 0;

  // After the step: sets the sensor outputs. Drives also learn the effort that their gear carried
  // (JointSample::effort).
  virtual void publish(std::span<const JointSample> samples, std::span<double> sensor_outputs) = 0;

  // Commanded minus actual position of each joint, for observers of the world. 0 where nothing is commanded.
  virtual void following_errors(std::span<double> errors) const = 0;

  // The controller that held the lease went away without releasing it, or missed its deadline.
  virtual void controller_lost() = 0;

  // Somebody put joints elsewhere, between ticks: `moved` names them, by their place in `samples`, which says
  // where all joints are now. Drives follow: they stand there until they get a new command.
  virtual void place(std::span<const std::size_t> /*moved*/, std::span<const JointSample> /*samples*/) {}

  // Back to the state after construction.
  virtual void reset() = 0;

  virtual std::vector<protocol::Parameter> parameters() const { return {}; }
  // Returns the reason of a refusal; nothing if done.
  virtual std::optional<std::string> set_parameter(const std::string& name,
                                                   const protocol::ParameterValue& value);

  // Blackboards by index in description(). The bytes stay valid until the next call on the tick's thread.
  // A write changes the content as write_into() does, or not at all.
  virtual std::span<const std::byte> read_blackboard(std::size_t) const { return {}; }
  virtual std::optional<std::string> write_blackboard(std::size_t index, std::uint64_t offset,
                                                      std::span<const std::byte> data);

  // Faults on purpose (fault_kinds.h). has() says whether the part has the thing that a kind breaks.
  // refuse_fault() returns the reason why a fault cannot act on this part; nothing if it can. Both never
  // change, and any thread may call them. set_faults() brings all faults that act from now on, in place of
  // those before.
  virtual bool has(FaultTarget target) const { return target == FaultTarget::kAnyPart; }
  virtual std::optional<std::string> refuse_fault(const Fault& fault) const;
  virtual void set_faults(std::span<const ActiveFault>) {}

  // The part's modules on a field bus, for telegrams between ticks; null: the part has no bus.
  virtual powercube::ModuleBus* modules() { return nullptr; }

  // Real parts only. Exchanges messages with the hardware without waiting. Called between ticks, as often as
  // possible.
  virtual void pump() {}
  // Real parts only. Stops everything that moves, before the part is destroyed. Waits for it, a second at
  // most.
  virtual void stand_down() {}

  // For a part with drives: how often one of them has tripped, and which are in fault now, why, with numbers,
  // and what to try, a line each. `since`: only those that tripped after so many trips. For people and logs;
  // no state of the part. The text allocates.
  virtual std::uint64_t trips() const { return 0; }
  virtual std::string trip_text(std::uint64_t /*since*/ = 0) const { return {}; }

  // For a part from a plug-in: why its code has failed, or empty while it works. Null for all others.
  virtual const std::string* node_fault() const { return nullptr; }

  virtual void save(StateWriter& to) const = 0;
  virtual void load(StateReader& from) = 0;
};

// Writes `data` into the content of a blackboard. At offset 0 it becomes the whole content; elsewhere it
// overwrites what is there, and may go on beyond the end. False, with nothing changed: the offset is beyond
// the end.
bool write_into(std::vector<std::byte>& content, std::uint64_t offset, std::span<const std::byte> data);

// The options of a part in front of real modules.
struct RealOptions {
  bool execution_enable = false;        // initial value of the port, which an operator decides
  bool watchdog = false;                // true: the modules stop by themselves when this process is gone
  std::int64_t answer_ns = 50'000'000;  // how long to wait for each answer
  int tries = 3;                        // how often to send each request, in all
};

}  // namespace visum::hwparts
