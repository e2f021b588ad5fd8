// Compares numbers to the last bit: -0 and 0 differ, and a NaN is equal to itself. Pure
// functions.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <cstring>

namespace visum::world {

using TwoNumbers = long long __attribute__((vector_size(16)));  // as bits

inline TwoNumbers two_numbers_at(const double* from) {
  TwoNumbers bits;
  std::memcpy(&bits, from, sizeof(bits));
  return bits;
}

inline bool are_same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline bool are_same_bits(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const double *x = a.coeffs().data(), *y = b.coeffs().data();
  const TwoNumbers differ =
      (two_numbers_at(x) ^ two_numbers_at(y)) | (two_numbers_at(x + 2) ^ two_numbers_at(y + 2));
  return (differ[0] | differ[1]) == 0;
}

inline bool are_same_bits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const TwoNumbers differ = two_numbers_at(a.data()) ^ two_numbers_at(b.data());
  return (differ[0] | differ[1]) == 0 && are_same_bits(a.z(), b.z());
}

}  // namespace visum::world
