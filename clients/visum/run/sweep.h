// The `sweep:` of a scenario, which stands for many runs. Each entry is a name with values. There is a run
// for each combination; the last name changes fastest. With `sampling:` the runs are points of the space that
// the names span instead (sampling.h). In the rest of the file ${name} stands for the run's value
// (protocol/config/expand.h). The values of a run are computed when they are asked for.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "clients/visum/run/distribution.h"
#include "clients/visum/run/sampling.h"
#include "protocol/config/expand.h"

namespace visum::run {

// One point of the space: what each ${name} stands for.
struct SweepPoint {
  config::Variables variables;
  std::vector<std::pair<std::string, std::string>> described;  // for people, in the order of the file
};

class Sweep {
 public:
  static constexpr std::size_t kMaxRuns = 1'000'000'000;
  static constexpr std::size_t kMaxListed = 10'000;  // values that a list may hold
  static constexpr std::size_t kMaxAxes = 16;

  // `root` is the scenario's whole file. Without `sweep:` there is one run. Throws config::ConfigError.
  explicit Sweep(const config::Node& root);

  bool given() const { return !axes_.empty(); }
  std::size_t runs() const;
  std::size_t axes() const { return axes_.size(); }
  SweepPoint point(std::size_t run) const;  // runs count from 1
  // Where that is in the space: for each name the share of its distribution, or of its list, in (0, 1).
  std::vector<double> shares(std::size_t run) const;
  SweepPoint point_at(const std::vector<double>& shares) const;
  // `values`: a map that gives each name one value. Throws config::ConfigError.
  SweepPoint point_of(const config::Node& values) const;

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
  static config::Node value_in(const Axis& axis, double share);
  std::size_t index_in(std::size_t axis, std::size_t run) const;  // where all combinations are tried
  SweepPoint point_by(const std::function<config::Node(std::size_t axis)>& value) const;

  std::vector<Axis> axes_;
  std::optional<Sampling> sampling_;
};

}  // namespace visum::run
