#include "hwparts/drive/portable_tanh.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace visum::drive {
namespace {

// 1/1!, 1/2!, ... 1/14!
constexpr std::array kInverseFactorials = [] {
  std::array<double, 14> result{};
  double factorial = 1.0;  // exact: 14! < 2^53
  for (std::size_t n = 0; n < result.size(); ++n) {
    factorial *= static_cast<double>(n + 1);
    result[n] = 1.0 / factorial;
  }
  return result;
}();

// e^r - 1 for |r| <= ln(2)/2 by its Taylor series, with the odd and the even terms each in Horner form. The
// first term left out is below 1e-17 of the sum.
double small_expm1(double r) {
  const double square = r * r;
  double odd = 0.0, even = 0.0;
  for (std::size_t n = kInverseFactorials.size(); n >= 2; n -= 2) {
    even = kInverseFactorials[n - 1] + square * even;
    odd = kInverseFactorials[n - 2] + square * odd;
  }
  return r * odd + square * even;
}

// e^y - 1 for 0 <= y <= 40, with y = n ln2 + r. ln2 is split in two so that n * kLn2High is exact.
double expm1_positive(double y) {
  constexpr double kInvLn2 = 1.4426950408889634;
  constexpr double kLn2High = 6.93147180369123816490e-01;
  constexpr double kLn2Low = 1.90821492927058770002e-10;
  const auto whole = static_cast<std::int64_t>(y * kInvLn2 + 0.5);
  const auto n = static_cast<double>(whole);
  const double r = (y - n * kLn2High) - n * kLn2Low;
  constexpr int kExponentBias = 1023, kMantissaBits = 52;
  const auto scale = std::bit_cast<double>((whole + kExponentBias) << kMantissaBits);  // 2^n
  return scale * small_expm1(r) + (scale - 1.0);
}

}  // namespace

double portable_tanh(double x) {
  const double magnitude = std::abs(x);
  if (!(magnitude <= 20.0)) return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x;  // the last: not a number
  const double e = expm1_positive(2.0 * magnitude);                     // tanh x = (e^2x - 1) / (e^2x + 1)
  return std::copysign(e / (e + 2.0), x);
}

}  // namespace visum::drive
