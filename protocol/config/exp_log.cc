#include "protocol/config/exp_log.h"

#include <cmath>
#include <limits>

namespace visum::config {
namespace {

constexpr double kLn2High =
    6.93147180369123816490e-01;  // its last 20 bits are 0, so that n times it is exact
constexpr double kLn2Low = 1.90821492927058770002e-10;
constexpr double kByLn2 = 1.44269504088896338700e+00;
constexpr double kSqrtHalf = 0.70710678118654752440;
constexpr double kExp[] = {1.66666666666666019037e-01, -2.77777777770155933842e-03,
                           6.61375632143793436117e-05, -1.65339022054652515390e-06,
                           4.13813679705723846039e-08};
constexpr double kLog[] = {6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01,
                           2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01,
                           1.479819860511658591e-01};

}  // namespace

double exponential(double x) {
  if (std::isnan(x)) return x;
  if (x > 709.8) return std::numeric_limits<double>::infinity();
  if (x < -745.2) return 0.0;
  const double n = std::floor(x * kByLn2 + 0.5);
  const double high = x - n * kLn2High, low = n * kLn2Low;
  const double r = high - low, t = r * r;
  const double c = r - t * (kExp[0] + t * (kExp[1] + t * (kExp[2] + t * (kExp[3] + t * kExp[4]))));
  return std::ldexp(1.0 - ((low - r * c / (2.0 - c)) - high), static_cast<int>(n));
}

double logarithm(double x) {
  if (!std::isnormal(x) || x < 0.0) return std::numeric_limits<double>::quiet_NaN();
  int exponent = 0;
  double fraction = std::frexp(x, &exponent);  // 1/2 to 1
  if (fraction < kSqrtHalf) {
    fraction *= 2.0;
    --exponent;
  }
  const double n = exponent, f = fraction - 1.0;
  const double s = f / (2.0 + f), z = s * s, w = z * z;
  const double odd = z * (kLog[0] + w * (kLog[2] + w * (kLog[4] + w * kLog[6])));
  const double even = w * (kLog[1] + w * (kLog[3] + w * kLog[5]));
  const double half = 0.5 * f * f;
  return n * kLn2High - ((half - (s * (half + odd + even) + n * kLn2Low)) - f);
}

}  // namespace visum::config
