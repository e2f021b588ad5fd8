#include "server/dynamics/impulse/loop_factor.h"

#include <algorithm>
#include <cmath>

namespace visum::dynamics::impulse {
namespace {

constexpr double kDependent = 1e-10;

}  // namespace

void LoopFactor::clear() {
  first_.clear();
  start_.clear();
  scale_.clear();
  lower_.clear();
}

void LoopFactor::add(std::size_t first, double scale) {
  start_.push_back(lower_.size());
  lower_.resize(lower_.size() + size() - first + 1, 0.0);
  first_.push_back(first);
  scale_.push_back(scale);
}

std::size_t LoopFactor::rank() const {
  return size() -
         static_cast<std::size_t>(std::count(inverse_diagonal_.begin(), inverse_diagonal_.end(), 0.0));
}

// l_ij = (a_ij - sum l_ik l_jk) / l_jj,  l_ii^2 = a_ii - sum l_ik^2.
void LoopFactor::factor() {
  inverse_diagonal_.resize(size());
  least_share_ = 1.0;
  for (std::size_t i = 0; i < size(); ++i) {
    double* const ri = row(i);
    double pivot = ri[i];
    for (std::size_t j = first_[i]; j < i; ++j) {
      const double* const rj = row(j);
      for (std::size_t k = std::max(first_[i], first_[j]); k < j; ++k) ri[j] -= ri[k] * rj[k];
      ri[j] *= inverse_diagonal_[j];
      pivot -= ri[j] * ri[j];
    }
    const bool counts = pivot > kDependent * scale_[i];
    inverse_diagonal_[i] = counts ? 1.0 / std::sqrt(pivot) : 0.0;
    if (counts) least_share_ = std::min(least_share_, pivot / scale_[i]);
  }
}

void LoopFactor::solve(std::vector<double>& b) const {
  for (std::size_t i = 0; i < size(); ++i) {
    const double* const ri = row(i);
    for (std::size_t j = first_[i]; j < i; ++j) b[i] -= ri[j] * b[j];
    b[i] *= inverse_diagonal_[i];
  }
  for (std::size_t i = size(); i-- > 0;) {
    const double* const ri = row(i);
    b[i] *= inverse_diagonal_[i];
    for (std::size_t j = first_[i]; j < i; ++j) b[j] -= ri[j] * b[i];
  }
}

}  // namespace visum::dynamics::impulse
