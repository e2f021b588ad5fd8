// A part is a process: a group with a cyclic loop. It is the client of the parts below it, and serves the
// parts above it over TCP. In each cycle it senses before it controls.
//
//   class Motion : public visum::mca::Part {
//    public:
//     MCA_CONTROLLER_INPUT(eCI_TARGET_1, eCI_DIMENSION);
//     ...
//     explicit Motion(const std::string& name) : Part(name, visum::mca::ports<Motion>()) {
//       auto& ramp = add<Ramp>("Ramp");
//       AddEdge(controller_input(), ramp.controller_input());
//     }
//   };
//   int main(int argc, char** argv) {
//     return visum::mca::run<Motion>("motion", "Moves the arm", argc, argv);
//   }
//
// In lockstep all parts of a controller act in one order, whatever the processes do: the lowest senses first,
// the uppermost controls first. A part goes on once each part above it has sent what belongs to this cycle.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "clients/mca/group.h"
#include "clients/mca/lower.h"
#include "clients/mca/options.h"

namespace visum::protocol {
struct OverrideModulePort;  // module_messages.h
struct SetModuleParameter;
}  // namespace visum::protocol

namespace visum::mca {

class Door;

class Part : public Group {
 public:
  // `period_ns`: of its cycle, unless --period says otherwise.
  Part(const std::string& name, PortNames names, std::int64_t period_ns = 5'000'000);
  ~Part() override;

  // Connects a part below. By default each controller output goes to the controller input of the same name,
  // and, from the first part below, each sensor output to the sensor input of the same name. `number` counts
  // the parts below from 0. Only one of them should be sensed.
  virtual void Connect(Lower& lower, std::size_t number);

  // Runs the part until it is ended, interrupted, or lost. Returns the exit code of the program.
  int run(const Options& options);

  std::int64_t loop_time_ns() const { return loop_time_ns_; }
  const Options& options() const { return options_; }
  void end() { ended_ = true; }
  const std::vector<Blackboard*>& blackboards() const { return blackboards_; }
  void debug(const Module& module, int level, const std::string& domain, const std::string& text) const;

 private:
  friend class Blackboard;
  void keep(Blackboard& board);
  void connect_lower_parts();
  void check_version() const;
  void announce();
  void report();
  void take_orders();
  template <typename Order>
  void take_order(const Order& wanted);
  void apply(const protocol::OverrideModulePort& wanted);
  void apply(const protocol::SetModuleParameter& wanted);
  void loop();
  bool cycle();
  void wait_for_next_cycle();
  bool in_lockstep() const { return !lower_.empty() && lower_.front()->in_lockstep(); }

  Options options_;
  std::vector<std::unique_ptr<Lower>> lower_;
  std::unique_ptr<Door> door_;
  std::vector<Blackboard*> blackboards_;
  std::int64_t loop_time_ns_ = 0;
  bool ended_ = false;
  std::chrono::steady_clock::time_point due_{}, report_due_{};
};

// Reads the command line, makes the part, and runs it. `name` is the part's name, unless --name gives another
// one; `about` is a line for --help.
using MakePart = std::function<std::unique_ptr<Part>(const std::string& name)>;
int run(const MakePart& make, const std::string& name, const std::string& about, int argc,
        const char* const* argv);
template <typename T>
int run(const std::string& name, const std::string& about, int argc, const char* const* argv) {
  return run([](const std::string& own) { return std::make_unique<T>(own); }, name, about, argc, argv);
}

}  // namespace visum::mca
