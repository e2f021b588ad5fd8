// Finds which parameters of a campaign matter for a check: the share of the margin's variance that goes with
// each parameter alone, the first-order Sobol index. It is estimated from the runs that are there, by groups
// of equal or neighbouring values. Interactions of parameters show in none of them. Any one thread.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "clients/visum/campaign/results.h"

namespace visum::campaign {

struct Influence {
  std::string parameter;
  double share = 0.0;  // 0 to 1
};

class InfluenceOfParameters {
 public:
  static constexpr std::size_t kMostRuns = 100'000;  // the first of a campaign
  static constexpr std::size_t kMostGroups = 32;

  // Reads the parameters of runs up to number `last`.
  InfluenceOfParameters(Results& results, std::size_t last);
  // The largest first. Empty where there are too few runs, or the margin is the same in all.
  std::vector<Influence> on(const std::string& check) const;

 private:
  struct Parameter {
    std::string name;
    std::map<std::size_t, std::string> values;  // by run
  };
  Results& results_;
  const std::size_t last_;
  std::vector<Parameter> parameters_;
};

// The share of the variance of `values` that lies between the groups, without what chance alone would put
// there: Kelley's epsilon squared (An unbiased correlation ratio measure, PNAS 21, 1935). `groups`: by value,
// below `count`. 0 where it cannot be told.
double share_between(const std::vector<double>& values, const std::vector<std::size_t>& groups,
                     std::size_t count);

}  // namespace visum::campaign
