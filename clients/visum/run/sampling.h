// The `sampling:` of a scenario: how many points of the sweep's space are tried, and how they lie. Each point
// is computed from its number alone, so any number of runs takes no memory, and any process finds the same
// points.
//
//   sampling: {method: sobol, runs: 10000, seed: 1}
#pragma once

#include <cstdint>
#include <optional>

#include "protocol/config/config.h"

namespace visum::run {

// In (0, 1): a number that looks random, for each axis and number of a seed. The same on every processor.
double random_share(std::uint64_t seed, std::size_t axis, std::uint64_t number);

class Sampling {
 public:
  enum class Method {
    kRandom,          // independent points
    kLatinHypercube,  // of each name's range, each of `runs` equal pieces is met once
    kSobol,  // Sobol's sequence (Joe and Kuo, 2008), shifted by the seed: even, and more so with time
  };

  // Nothing where the file has no `sampling:`. Throws ConfigError.
  static std::optional<Sampling> read(const config::Node& root);

  std::size_t runs() const { return runs_; }
  // In (0, 1): coordinate `axis` of the point of a run, which counts from 1.
  double share(std::size_t axis, std::size_t run) const;

 private:
  Method method_ = Method::kRandom;
  std::size_t runs_ = 1;
  std::uint64_t seed_ = 0;
};

}  // namespace visum::run
