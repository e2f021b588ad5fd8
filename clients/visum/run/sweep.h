// The `sweep:` of a scenario, which stands for many runs. Each entry is a name with values. There is a run
// for each combination; the last name changes fastest. With `sampling:` the runs are points of the space that
// the names span instead (sampling.h). In the rest of the file ${name} stands for the run's value
// (protocol/config/expand.h). The values of a run are computed when they are asked for.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "clients/visum/run/distribution.h"
#include "clients/visum/run/sampling.h"
#include "protocol/config/expand.h"

namespace visum::run {

class Sweep {
 public:
  static constexpr std::size_t kMaxRuns = 1'000'000'000;
  static constexpr std::size_t kMaxListed = 10'000;  // values that a list may hold
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
  using List = std::vector<config::Node>;
  struct Range {
    double from = 0.0, width = 1.0;
    std::size_t count = 1;
  };
  struct Axis {
    std::string name;
    config::Node node;
    std::variant<List, Range, Distribution> values;
  };
  static Axis read_axis(const std::string& name, const config::Node& node);
  static Range read_range(const config::Node& node);
  static std::size_t count(const Axis& axis);  // of a list or range
  static config::Node value_at(const Axis& axis, std::size_t index);

  std::vector<Axis> axes_;
  std::optional<Sampling> sampling_;
};

}  // namespace visum::run
