// Six doubles, as a row of a block of 6 x 6, or a velocity (angular, linear): four lanes and two.
#pragma once

#include "server/dynamics/impulse/lanes/lanes.h"

namespace visum::dynamics::impulse {
namespace {

struct Six {
  Lanes four;
  Pair two;
};

VISUM_LANES_INLINE Six load_six(const double* from) {
  return {load(from), load_pair(from + 4)};
}
VISUM_LANES_INLINE void store_six(double* to, Six from) {
  store(to, from.four);
  store_pair(to + 4, from.two);
}
VISUM_LANES_INLINE Six operator+(Six a, Six b) {
  return {a.four + b.four, a.two + b.two};
}
VISUM_LANES_INLINE Six operator-(Six a, Six b) {
  return {a.four - b.four, a.two - b.two};
}
VISUM_LANES_INLINE Six operator*(double a, Six b) {
  return {all(a) * b.four, Pair{a, a} * b.two};
}

template <int k>
VISUM_LANES_INLINE double lane(const Six& a) {
  if constexpr (k < 4)
    return lane<k>(a.four);
  else
    return a.two[k - 4];
}
template <int k>
VISUM_LANES_INLINE Six with_lane(Six a, double value) {
  if constexpr (k < 4)
    a.four = with_lane<k>(a.four, value);
  else
    a.two[k - 4] = value;
  return a;
}

}  // namespace
}  // namespace visum::dynamics::impulse
