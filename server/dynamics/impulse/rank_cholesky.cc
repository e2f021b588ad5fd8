#include "server/dynamics/impulse/rank_cholesky.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace visum::dynamics::impulse {
namespace {

constexpr double kDependent = 1e-10;

}  // namespace

void RankCholesky::resize(std::size_t n) {
  n_ = n;
  matrix_.resize(n * n);
  scale_.resize(n);
  order_.resize(n);
  sorted_.resize(n);
}

void RankCholesky::swap(std::size_t i, std::size_t k) {
  if (i == k) return;
  std::swap(order_[i], order_[k]);
  std::swap(scale_[i], scale_[k]);
  for (std::size_t j = 0; j < n_; ++j) std::swap(at(i, j), at(k, j));
  for (std::size_t j = 0; j < n_; ++j) std::swap(at(j, i), at(j, k));
}

void RankCholesky::eliminate(std::size_t k) {
  const double root = std::sqrt(at(k, k));
  at(k, k) = root;
  for (std::size_t i = k + 1; i < n_; ++i) at(i, k) /= root;
  for (std::size_t i = k + 1; i < n_; ++i) {
    const double factor = at(i, k);
    if (factor == 0.0) continue;
    for (std::size_t j = k + 1; j <= i; ++j) at(i, j) -= factor * at(j, k);
  }
}

void RankCholesky::factor() {
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  for (std::size_t i = 0; i < n_; ++i) scale_[i] = at(i, i) > 0.0 ? 1.0 / at(i, i) : 0.0;
  for (rank_ = 0; rank_ < n_; ++rank_) {
    std::size_t best = rank_;
    for (std::size_t i = rank_ + 1; i < n_; ++i)
      if (at(i, i) * scale_[i] > at(best, best) * scale_[best]) best = i;
    if (!(at(best, best) * scale_[best] > kDependent)) return;
    // Only the lower half is kept up: mirror what swap() is to move.
    for (std::size_t i = rank_; i < n_; ++i)
      for (std::size_t j = rank_; j < i; ++j) at(j, i) = at(i, j);
    swap(best, rank_);
    eliminate(rank_);
  }
}

void RankCholesky::solve(std::vector<double>& b) {
  for (std::size_t i = 0; i < n_; ++i) sorted_[i] = b[order_[i]];
  for (std::size_t i = 0; i < rank_; ++i) {
    for (std::size_t j = 0; j < i; ++j) sorted_[i] -= at(i, j) * sorted_[j];
    sorted_[i] /= at(i, i);
  }
  for (std::size_t i = rank_; i-- > 0;) {
    for (std::size_t j = i + 1; j < rank_; ++j) sorted_[i] -= at(j, i) * sorted_[j];
    sorted_[i] /= at(i, i);
  }
  for (std::size_t i = 0; i < n_; ++i) b[order_[i]] = i < rank_ ? sorted_[i] : 0.0;
}

}  // namespace visum::dynamics::impulse
