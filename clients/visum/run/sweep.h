// The `sweep:` of a scenario, which stands for many runs. Each entry is a name with values. There is a run
// for each combination; the last name changes fastest. In the rest of the file ${name} stands for the run's
// value (protocol/config/expand.h).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "protocol/config/expand.h"

namespace visum::run {

class Sweep {
 public:
  static constexpr std::size_t kMaxRuns = 10'000;
  static constexpr std::size_t kMaxAxes = 16;

  // `root` is the scenario's whole file. Without `sweep:` there is one run. Throws config::ConfigError.
  explicit Sweep(const config::Node& root);

  bool given() const { return !axes_.empty(); }
  std::size_t runs() const;
  config::Node value(std::size_t axis, std::size_t run) const;  // runs count from 1
  config::Variables variables(std::size_t run) const;
  // For people: name and value, in the order of the file.
  std::vector<std::pair<std::string, std::string>> described(std::size_t run) const;

 private:
  struct Axis {
    std::string name;
    std::vector<config::Node> values;
  };
  std::vector<Axis> axes_;
};

}  // namespace visum::run
