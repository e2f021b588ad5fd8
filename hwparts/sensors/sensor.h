// A hardware part that measures. The world says what is true, the sensor what is read of it: later, rounded,
// noisy, failing. It drives no joint and takes no commands; its readings are sensor outputs, or a blackboard
// where they are many. The last port, `Changed`, counts the readings shown: 0 means none yet. What a silent
// one would have shown counts, too, and the newest of it is shown when the silence ends.
//
// Order of calls, beside a part's (hwparts/part.h): before each publish(), if due(), truth() is filled.
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

// What a kind consists of. `numbers` says how each number of a reading is disturbed; truths are as many.
struct Layout {
  const char* kind;
  std::vector<protocol::Port> ports;  // without `Changed`
  std::vector<protocol::Blackboard> blackboards;
  std::vector<Accuracy> numbers;
};

class Sensor : public hwparts::Part {
 public:
  Sensor(const SensorContext& context, Layout layout);

  bool due() const;  // the next publish() takes a sample
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
  // What is read of the truth without a fault, before steps and ends. By default each number by itself.
  virtual void read(std::span<const double> truth, std::span<double> reading, Random& random) const;
  // Puts a reading onto the ports; by default its numbers are the ports.
  virtual void show(std::span<const double> reading, std::span<double> sensor_outputs);
  // After load() and reset(): what else hangs on the reading that is shown.
  virtual void shown_again(std::span<const double>) {}
  // Why the kind does not fail in this way; null: it does.
  virtual const char* why_not(Failure) const { return nullptr; }
  // Whether readings are seen on a blackboard.
  virtual bool fills_blackboard() const { return false; }
  // Another reading than so far. Forgets what was read, and what is on its way.
  void set_numbers(std::vector<Accuracy> numbers);

  double offset(std::size_t number) const { return offsets_[number]; }
  const Accuracy& accuracy(std::size_t number) const { return layout_.numbers[number]; }

 private:
  Failure failing() const {
    return by_fault_ == Failure::kOk || failure_ == Failure::kOff ? failure_ : by_fault_;
  }
  std::int64_t late_ns() const {
    return failing() == Failure::kDelayed ? kDelayedSamples * timing_.period_ns : 0;
  }
  void fail(Failure by_parameter, Failure by_fault);
  void draw_offsets();
  void sample();
  void disturb(std::span<double> reading);
  bool lost();

  Layout layout_;
  std::string name_;
  std::uint64_t seed_;
  Timing timing_;
  Failure initial_failure_;
  std::vector<double> truth_;
  std::vector<double> offsets_;  // drawn at start
  // What changes.
  Random random_;
  Failure failure_;                  // by the parameter
  Failure by_fault_ = Failure::kOk;  // by a fault, which goes before all but off; no state of the sensor
  bool silent_ = false;              // likewise: nobody hears of a reading
  std::int64_t now_ns_ = 0;
  std::int64_t samples_ = 0;
  std::uint64_t changed_ = 0;
  std::vector<double> last_;   // the last reading taken
  std::vector<double> shown_;  // the one on the ports
  ReadingQueue queue_;
  protocol::PartDescription description_;
};

// Keys that every sensor's entry may have; a kind's own come on top.
void allow_keys(const config::Node& entry, std::initializer_list<std::string_view> own);

}  // namespace visum::sensors
