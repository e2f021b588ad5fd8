// The system of rows that are few and mostly all act on each other, as those of one mechanism: full matrices
// in lanes. Larger systems have an envelope (envelope_lu.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "server/dynamics/impulse/lanes/kernels.h"

namespace visum::dynamics::impulse {

// Order of calls: start(), fill responses, then any number of times clear(), add() for each row that takes
// part, factor() and solve(). Owned by Rows, used on its thread. Allocates only while it grows.
class SmallSystem {
 public:
  explicit SmallSystem(const Kernels& by = kernels()) : kernels_(&by) {}
  // So many rows; responses that are not set are 0.
  void start(std::size_t rows);
  // The velocity of row i for a unit impulse on row j, and the other way round.
  void set_response(std::size_t i, std::size_t j, double velocity) {
    responses_[i * stride_ + j] = responses_[j * stride_ + i] = velocity;
  }
  // All of row i.
  void set_responses(std::size_t i, std::span<const double> velocities) {
    std::ranges::copy(velocities, &responses_[i * stride_]);
  }
  void clear() { rows_.clear(); }
  void add(const SmallRow& row) { rows_.push_back(row); }
  bool factor();                       // false where a pivot is not positive
  void solve(std::vector<double>& b);  // in place

 private:
  SmallMatrix matrix();

  const Kernels* kernels_;
  std::size_t stride_ = 0;
  std::vector<double> responses_, room_, upper_, lower_, inverse_;
  std::vector<SmallRow> rows_;
};

}  // namespace visum::dynamics::impulse
