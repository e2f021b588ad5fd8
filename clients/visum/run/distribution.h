// A distribution of a sampled name of a sweep: turns a share from (0, 1) into a value. Pure; the same bits on
// every processor.
//
//   {uniform: [0.2, 0.5]}
//   {log_uniform: [1, 100]}                       evenly by orders of magnitude
//   {normal: [0.5, 0.1]}                          mean, standard deviation
//   {normal: [0.5, 0.1], between: [0.2, 0.8]}     without what lies beyond
//   {integers: [1, 1000]}                         whole numbers, both ends included
#pragma once

#include <optional>
#include <string>

#include "protocol/config/config.h"

namespace visum::run {

class Distribution {
 public:
  // Nothing where the map is none of the above, but perhaps a range. Throws ConfigError.
  static std::optional<Distribution> read(const config::Node& node);

  // `share`: in (0, 1). As text, whose digits read back as the same bits.
  std::string value(double share) const;

 private:
  enum class Kind { kUniform, kLogUniform, kNormal, kIntegers };

  Kind kind_ = Kind::kUniform;
  double first_ = 0.0, second_ = 1.0;    // the ends, their logarithms, or mean and standard deviation
  double lowest_ = 0.0, highest_ = 1.0;  // normal: the shares that are left of all
};

// The value below which `share` of a standard normal distribution lies. `share`: in (0, 1). Wichura,
// Algorithm AS 241: The percentage points of the normal distribution, Applied Statistics 37 (1988), PPND16.
double normal_quantile(double share);

}  // namespace visum::run
