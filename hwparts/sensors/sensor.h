// A hardware part that measures. The world gives the truth; the sensor turns it into a reading that is late,
// rounded, noisy or failing. It drives no joint and takes no commands. Its readings are sensor outputs, or a
// blackboard where they are many. The last port, `Changed`, counts the readings shown: 0 means none yet.
// Readings that a silent sensor (fault `part_silent`) would have shown count, too, and the newest of them is
// shown when the silence ends.
//
// Order of calls, beside a part's (hwparts/part.h): before each publish(), if due(), the caller fills
// truth(). The simulation owns the sensor; it lives on the tick's thread. Only construction can fail.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hwparts/part.h"
#include "hwparts/sensors/accuracy.h"
#include "hwparts/sensors/failure.h"
#include "hwparts/sensors/reading_queue.h"
#include "hwparts/sensors/timing.h"

namespace visum::sensors {

struct SensorContext {
  std::string name;        // in the scene
  config::Node config;     // the sensor's entry in the scene file
  std::int64_t tick_ns;    // the tick's length
  std::uint64_t seed = 1;  // the scene's
};

// The ports and numbers of a kind. `numbers` has the errors of each number of a reading; the truth has as
// many numbers.
struct Layout {
  const char* kind;
  std::vector<protocol::Port> ports;  // without `Changed`
  std::vector<protocol::Blackboard> blackboards;
  std::vector<Accuracy> numbers;
  // Every number of the reading on the ports before the first sample: as if there were nothing to sense.
  double nothing = 0.0;
};

class Sensor : public hwparts::Part {
 public:
  Sensor(const SensorContext& context, Layout layout);

  bool due() const;  // true: the next publish() takes a sample
  std::span<double> truth() { return truth_; }

  const protocol::PartDescription& description() const final { return description_; }
  std::span<const std::size_t> joints() const final { return {}; }
  std::optional<std::string> refuse(std::span<const double>) const final { return {}; }
  void act(std::span<const double>, std::span<const hwparts::JointSample>,
           std::span<hwparts::JointDrive>) final {}
  void publish(std::span<const hwparts::JointSample>, std::span<double> sensor_outputs) final;
  void following_errors(std::span<double>) const final {}
  void controller_lost() final {}
  void reset() final;
  std::vector<protocol::Parameter> parameters() const override;
  std::optional<std::string> set_parameter(const std::string& name,
                                           const protocol::ParameterValue& value) override;
  bool has(hwparts::FaultTarget target) const final {
    return target == hwparts::FaultTarget::kSensor || target == hwparts::FaultTarget::kAnyPart;
  }
  std::optional<std::string> refuse_fault(const hwparts::Fault& fault) const final;
  void set_faults(std::span<const hwparts::ActiveFault> faults) final;
  void save(hwparts::StateWriter& to) const final;
  void load(hwparts::StateReader& from) final;

 protected:
  // Makes a reading of the truth, without a fault and before steps and ends of the range. By default it
  // treats each number by itself.
  virtual void read(std::span<const double> truth, std::span<double> reading, Random& random) const;
  // Puts a reading onto the ports. By default its numbers are the ports.
  virtual void show(std::span<const double> reading, std::span<double> sensor_outputs);
  // After load() and reset(): restores everything else that depends on the reading shown.
  virtual void shown_again(std::span<const double>) {}
  // The reason why the kind cannot fail in this way; null: it can.
  virtual const char* why_not(Failure) const { return nullptr; }
  // True: the readings are shown on a blackboard.
  virtual bool fills_blackboard() const { return false; }
  // Changes the numbers of a reading. Forgets all readings, also those on their way.
  void set_numbers(std::vector<Accuracy> numbers);

  double offset(std::size_t number) const { return offsets_[number]; }
  const Accuracy& accuracy(std::size_t number) const { return layout_.numbers[number]; }

 private:
  // The failure in force. A fault goes before the parameter's failure, except that off stays off.
  Failure failing() const {
    return by_fault_ == Failure::kOk || failure_ == Failure::kOff ? failure_ : by_fault_;
  }
  // The extra delay of the failure in force.
  std::int64_t late_ns() const {
    return failing() == Failure::kDelayed ? kDelayedSamples * timing_.period_ns : 0;
  }
  // Changes the failure in force. Takes the extra delay off readings that are on their way, if it ends:
  // otherwise fresh readings would queue behind them.
  void fail(Failure by_parameter, Failure by_fault);
  // Draws the constant offset of each number.
  void draw_offsets();
  // Makes a reading of truth() and queues it.
  void sample();
  // Applies failures that change values, then steps and the ends of the range.
  void disturb(std::span<double> reading);
  // True: the failure in force loses this reading.
  bool lost();

  Layout layout_;
  std::string name_;
  std::uint64_t seed_;
  Timing timing_;
  Failure initial_failure_;
  std::vector<double> truth_;
  std::vector<double> offsets_;  // drawn at start
  // The changing state.
  Random random_;
  Failure failure_;                  // by the parameter `Failure`
  Failure by_fault_ = Failure::kOk;  // by a fault; follows from the list of faults, so it is not saved
  bool silent_ = false;              // by a fault, likewise: no reading reaches the ports
  std::int64_t now_ns_ = 0;
  std::int64_t samples_ = 0;
  std::uint64_t changed_ = 0;
  std::vector<double> last_;   // the last reading taken
  std::vector<double> shown_;  // the reading on the ports
  ReadingQueue queue_;
  protocol::PartDescription description_;
};

// Refuses keys other than those that every sensor's entry may have, and the kind's `own`.
void allow_keys(const config::Node& entry, std::initializer_list<std::string_view> own);

}  // namespace visum::sensors
