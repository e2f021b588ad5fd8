#include "server/dynamics/impulse/small_system.h"

namespace visum::dynamics::impulse {
namespace {

// Whole lanes.
std::size_t padded(std::size_t count) {
  return (count + 3) & ~std::size_t{3};
}

}  // namespace

void SmallSystem::start(std::size_t rows) {
  stride_ = padded(rows);
  responses_.assign(rows * stride_, 0.0);
  room_.resize(stride_);
  // No more rows take part than there are.
  for (std::vector<double>* entries : {&upper_, &lower_})
    if (entries->size() < rows * stride_) entries->resize(rows * stride_);
  if (inverse_.size() < rows) inverse_.resize(rows);
}

SmallMatrix SmallSystem::matrix() {
  return {.responses = responses_.data(),
          .stride = stride_,
          .rows = rows_.data(),
          .count = rows_.size(),
          .height = padded(rows_.size()),
          .upper = upper_.data(),
          .lower = lower_.data(),
          .inverse = inverse_.data()};
}

bool SmallSystem::factor() {
  return kernels_->factor_small(matrix(), room_.data());
}

void SmallSystem::solve(std::vector<double>& b) {
  kernels_->solve_small(matrix(), b.data(), room_.data());
}

}  // namespace visum::dynamics::impulse
