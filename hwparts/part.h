// A hardware part: one named set of ports in front of drives or sensors, virtual or real. Knows no world and
// no socket.
//
// Order of calls: construction (may throw ConfigError); then, per tick, on the tick's thread: act(), and
// after the engines moved, publish(). Between ticks, on the same thread: latch(), reset(), set_parameter(),
// controller_lost(), set_faults(), save(), load(). refuse() and description() are constant and may be called
// from any thread, and so may refuse_now(), which is not. Nothing here allocates after construction, except
// description(), the parameter calls and refusals.
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

// What a part needs to know of a joint that it drives. From the robot's model.
struct JointInfo {
  std::string name;  // as in the URDF
  bool prismatic = false;
  double lower = 0.0;  // mechanical stops; lower > upper: none
  double upper = 0.0;
  double initial_position = 0.0;
};

struct PartContext {
  std::string name;               // in the scene
  config::Node config;            // the part's entry in the scene file
  std::vector<JointInfo> joints;  // those of the model that the entry names, in the model's order
  double tick_s;                  // the tick's length
  std::uint64_t seed = 1;         // the scene's
};

class Part {
 public:
  virtual ~Part() = default;

  virtual const protocol::PartDescription& description() const = 0;  // parameters' values as at construction

  // The joints that the part drives: indices into PartContext::joints, in the order of the spans below.
  virtual std::span<const std::size_t> joints() const = 0;

  // Why these controller inputs, already finite and inside their ports' ranges, cannot be taken as a whole;
  // nothing if they can.
  virtual std::optional<std::string> refuse(std::span<const double> controller_inputs) const = 0;

  // Why inputs that are good cannot be taken just now in place of those `before`; nothing if they can. For
  // parts that pass them on to somebody who may be away.
  virtual std::optional<std::string> refuse_now(std::span<const double> /*before*/,
                                                std::span<const double> /*controller_inputs*/) const {
    return std::nullopt;
  }

  // The inputs that the next act() will have, as they are after a write: for parts that are told things by
  // another way as well, and where it matters which came last.
  virtual void latch(std::span<const double> /*controller_inputs*/) {}

  // One tick's work of the drives: from inputs and what the joints do to what acts on them.
  virtual void act(std::span<const double> controller_inputs, std::span<const JointSample> samples,
                   std::span<JointDrive> drives) = 0;

  // After the step: what the sensors say. Also learns what the gear felt (JointSample::effort).
  virtual void publish(std::span<const JointSample> samples, std::span<double> sensor_outputs) = 0;

  // Commanded minus actual position per joint, for the world's truth. 0 where nothing is commanded.
  virtual void following_errors(std::span<double> errors) const = 0;

  // The controller that held the lease is gone without releasing it, or missed its deadline.
  virtual void controller_lost() = 0;

  // Back to the state after construction.
  virtual void reset() = 0;

  virtual std::vector<protocol::Parameter> parameters() const { return {}; }
  // Returns why not; nothing if done.
  virtual std::optional<std::string> set_parameter(const std::string& name,
                                                   const protocol::ParameterValue& value);

  // Blackboards by index in description(). The bytes stay valid until the next call on the tick's thread.
  virtual std::span<const std::byte> read_blackboard(std::size_t) const { return {}; }
  virtual std::optional<std::string> write_blackboard(std::size_t index, std::uint64_t offset,
                                                      std::span<const std::byte> data);

  // Faults (fault_kinds.h). Whether the part has what a kind breaks; why such a fault cannot act on it,
  // nothing if it can: constant, any thread. And all that act on it from now on, in place of those before.
  virtual bool has(FaultTarget target) const { return target == FaultTarget::kAnyPart; }
  virtual std::optional<std::string> refuse_fault(const Fault& fault) const;
  virtual void set_faults(std::span<const ActiveFault>) {}

  // The part's modules on a field bus, to be talked to between ticks; none: it has no bus.
  virtual powercube::ModuleBus* modules() { return nullptr; }

  // Real parts only. Moves what there is to and from the hardware, without waiting: as often as can be,
  // between ticks.
  virtual void pump() {}
  // Stops what moves, before the part goes; waits for it, a second at most.
  virtual void stand_down() {}

  // Where the part's code comes from a plug-in: why that has failed, empty while it works. Else null.
  virtual const std::string* node_fault() const { return nullptr; }

  virtual void save(StateWriter& to) const = 0;
  virtual void load(StateReader& from) = 0;
};

// How a part in front of real modules behaves.
struct RealOptions {
  bool execution_enable = false;        // initial value of the port: an operator's word
  bool watchdog = false;                // the modules stop by themselves when this process is gone
  std::int64_t answer_ns = 50'000'000;  // patience for each answer, then
  int tries = 3;                        // so often in all
};

}  // namespace visum::hwparts
