// Percentiles of many durations. Each duration is kept, so the percentiles are exact. For benchmarks only.
#pragma once

#include <algorithm>
#include <chrono>
#include <vector>

namespace visum::bench {

class Percentiles {
 public:
  explicit Percentiles(std::size_t expected) { microseconds_.reserve(expected); }
  void add(std::chrono::nanoseconds duration) {
    microseconds_.push_back(static_cast<double>(duration.count()) * 1e-3);
  }
  std::size_t count() const { return microseconds_.size(); }
  // In µs; q in 0..1.
  double at(double q) {
    if (microseconds_.empty()) return 0.0;
    const auto rank = static_cast<std::size_t>(q * static_cast<double>(microseconds_.size() - 1));
    std::ranges::nth_element(microseconds_, microseconds_.begin() + static_cast<std::ptrdiff_t>(rank));
    return microseconds_[rank];
  }

 private:
  std::vector<double> microseconds_;
};

}  // namespace visum::bench
