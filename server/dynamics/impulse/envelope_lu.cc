#include "server/dynamics/impulse/envelope_lu.h"

#include <algorithm>

namespace visum::dynamics::impulse {
namespace {

// A dot product in four sums of fixed order: every compiler gives the same bits, and the sums can run in
// parallel.
double dot(const double* a, const double* b, std::size_t from, std::size_t to) {
  double sum[4] = {0.0, 0.0, 0.0, 0.0};
  std::size_t k = from;
  for (; k + 4 <= to; k += 4)
    for (std::size_t part = 0; part < 4; ++part) sum[part] += a[k + part] * b[k + part];
  for (; k < to; ++k) sum[0] += a[k] * b[k];
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

}  // namespace

void EnvelopeLu::restart(std::size_t kept) {
  kept_ = kept;
  if (kept < size()) entries_ = start_[kept];
  first_.resize(kept);
  start_.resize(kept);
}

void EnvelopeLu::add(std::size_t first) {
  const std::size_t i = first_.size();
  first_.push_back(first);
  start_.push_back(entries_);
  entries_ += i - first + 1;
}

void EnvelopeLu::place() {
  const std::size_t from = kept_ < size() ? start_[kept_] : entries_;
  for (std::vector<double>* entries : {&lower_, &upper_}) {
    entries->resize(entries_);
    std::fill(entries->begin() + static_cast<std::ptrdiff_t>(from), entries->end(), 0.0);
  }
}

bool EnvelopeLu::factor() {
  inverse_diagonal_.resize(size());
  return kernels_->factor_envelope({.first = first_.data(),
                                    .start = start_.data(),
                                    .lower = lower_.data(),
                                    .upper = upper_.data(),
                                    .inverse_diagonal = inverse_diagonal_.data(),
                                    .begin = kept_,
                                    .count = size()});
}

void EnvelopeLu::solve(std::vector<double>& b) const {
  for (std::size_t i = 0; i < size(); ++i) b[i] -= dot(row(i), b.data(), first_[i], i);
  for (std::size_t i = size(); i-- > 0;) {
    const double* const ci = column(i);
    b[i] *= inverse_diagonal_[i];
    for (std::size_t j = first_[i]; j < i; ++j) b[j] -= ci[j] * b[i];
  }
}

}  // namespace visum::dynamics::impulse
