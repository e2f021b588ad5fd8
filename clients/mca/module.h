// The building block of a controller in MCA2's manner. Data comes down as controller input, is worked on in
// Control() and goes on as controller output. It comes up as sensor input, is worked on in Sense() and goes
// on as sensor output.
//
//   class Ramp : public visum::mca::Module {
//    public:
//     MCA_CONTROLLER_INPUT(eCI_DESIRED_ANGLE, eCI_DIMENSION);
//     MCA_CONTROLLER_OUTPUT(eCO_TARGET, eCO_DIMENSION);
//     explicit Ramp(visum::mca::Place place) : Module(place, visum::mca::ports<Ramp>()) {}
//     void Control() override {
//       const double step = speed_() * 1e-9 * static_cast<double>(Period());
//       const double way = ControllerInput(eCI_DESIRED_ANGLE) - ControllerOutput(eCO_TARGET);
//       ControllerOutput(eCO_TARGET) += std::clamp(way, -step, step);
//     }
//
//    private:
//     visum::mca::Parameter<double> speed_{*this, "Speed", 0.5, {.minimum = 0.0, .maximum = 2.0}};
//   };
//
// Everything happens on the one thread of the part's loop.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/mca/blackboard.h"
#include "clients/mca/names.h"
#include "clients/mca/parameter.h"
#include "clients/mca/vector.h"

namespace visum::mca {

class Group;
class Part;

// Where a module stands: in which group, under which name. Group::add() makes one.
struct Place {
  Group* group = nullptr;  // null: a part
  std::string name;        // without '/'
};

// How long calls of a method take, as an average that forgets.
class CallTime {
 public:
  void add(std::int64_t ns);
  std::int64_t mean_ns() const { return static_cast<std::int64_t>(mean_ns_); }

 private:
  double mean_ns_ = -1.0;
};

class Module {
 public:
  // Throws std::invalid_argument if the name is empty or has a '/'.
  Module(Place place, PortNames names);
  virtual ~Module() = default;
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  // The two methods of MCA2. Sense() comes first in each cycle.
  virtual void Control() {}
  virtual void Sense() {}

  const std::string& name() const { return name_; }
  std::string path() const;  // "Arm/Wrist/Ramp"; empty for a part
  // The time of the part in ns. It advances by the nominal period with each cycle, also under time scaling;
  // take time from here and not from the wall clock.
  std::int64_t LoopTime() const;
  std::int64_t Period() const;  // ns
  // Ends the part in good order, once this cycle is over.
  void EndLoop();

  Vector& controller_input() { return controller_input_; }
  Vector& controller_output() { return controller_output_; }
  Vector& sensor_input() { return sensor_input_; }
  Vector& sensor_output() { return sensor_output_; }
  const std::vector<ParameterBase*>& parameters() const { return parameters_; }
  const CallTime& control_time() const { return control_time_; }
  const CallTime& sense_time() const { return sense_time_; }

  // One cycle's half each, around Control() and Sense(): counts the time and notes what was seen.
  void run_control();
  void run_sense();

 protected:
  double ControllerInput(std::size_t port) const { return controller_input_.at(port); }
  double& ControllerOutput(std::size_t port) { return controller_output_.at(port); }
  double SensorInput(std::size_t port) const { return sensor_input_.at(port); }
  double& SensorOutput(std::size_t port) { return sensor_output_.at(port); }
  // True if a value has changed since the last Control() or Sense(). All count as changed in the first call.
  // A command that is to act once, such as Reset, is a counter: it acts where its number has changed.
  bool ControllerInputChanged() const { return controller_input_.changed(); }
  bool ControllerInputChanged(std::size_t port) const { return controller_input_.changed(port); }
  bool SensorInputChanged() const { return sensor_input_.changed(); }
  bool SensorInputChanged(std::size_t port) const { return sensor_input_.changed(port); }
  // True if a parameter has changed since the last Control(); in the first call also.
  bool ParametersChanged() const { return parameters_changed_; }
  // Prints a line if the part's debug level and domains ask for it, or if this module's flag is set.
  void Debug(int level, const std::string& domain, const std::string& text) const;

 private:
  friend class ParameterBase;
  friend class Blackboard;
  Part& part() const;

  Group* const group_;
  const std::string name_;
  Vector controller_input_, controller_output_, sensor_input_, sensor_output_;
  std::vector<ParameterBase*> parameters_;
  bool parameters_changed_ = true;
  CallTime control_time_, sense_time_;
};

}  // namespace visum::mca
