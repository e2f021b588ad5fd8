#include "protocol/config/trig.h"

#include <cmath>
#include <limits>

namespace visum::config {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTwoByPi = 6.36619772367581382433e-01;
constexpr double kHalfPiHigh = 1.57079632673412561417e+00;  // 33 bits, so that n times it is exact
constexpr double kHalfPiLow = 6.07710050650619224932e-11;
constexpr double kMost = 1e6;  // up to here n * kHalfPiHigh is exact
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kRound = 6755399441055744.0;  // 1.5·2^52: adding it rounds to a whole number

constexpr double kAtanHigh[] = {4.63647609000806093515e-01, 7.85398163397448278999e-01,
                                9.82793723247329054082e-01, 1.57079632679489655800e+00};
constexpr double kAtanLow[] = {2.26987774529616870924e-17, 3.06161699786838301793e-17,
                               1.39033110312309984516e-17, 6.12323399573676603587e-17};
constexpr double kAtan[] = {
    3.33333333333329318027e-01,  -1.99999999998764832476e-01, 1.42857142725034663711e-01,
    -1.11111104054623557880e-01, 9.09088713343650656196e-02,  -7.69187620504482999495e-02,
    6.66107313738753120669e-02,  -5.83357013379057348645e-02, 4.97687799461593236017e-02,
    -3.65315727442169155270e-02, 1.62858201153657823623e-02};

// x - atan(x) for |x| <= 7/16, as two sums that do not wait for each other.
double atan_rest(double x) {
  const double z = x * x, w = z * z;
  const auto& a = kAtan;
  const double even = z * (a[0] + w * (a[2] + w * (a[4] + w * (a[6] + w * (a[8] + w * a[10])))));
  const double odd = w * (a[1] + w * (a[3] + w * (a[5] + w * (a[7] + w * a[9]))));
  return x * (even + odd);
}

// atan(y/x) for y, x >= 0, not both 0. One division: atan(y/x) = atan(c) + atan((y - c x)/(x + c y)).
double atan_positive(double y, double x) {
  if (y < 0.4375 * x) {
    const double t = y / x;
    return t - atan_rest(t);
  }
  int part = 3;
  double above = -x, below = y;
  if (y < 0.6875 * x) {
    part = 0;
    above = 2.0 * y - x;
    below = 2.0 * x + y;
  } else if (y < 1.1875 * x) {
    part = 1;
    above = y - x;
    below = y + x;
  } else if (y < 2.4375 * x) {
    part = 2;
    above = y - 1.5 * x;
    below = x + 1.5 * y;
  }
  const double t = above / below;
  return kAtanHigh[part] - ((atan_rest(t) - kAtanLow[part]) - t);
}

}  // namespace

SinCos sin_cos_large(double x) {
  if (!(std::abs(x) <= kMost)) return {kNaN, kNaN};
  const double n = (x * kTwoByPi + kRound) - kRound;
  const SinCos r = sin_cos_small((x - n * kHalfPiHigh) - n * kHalfPiLow);
  switch (static_cast<long long>(n) & 3) {
    case 0:
      return r;
    case 1:
      return {r.cos, -r.sin};
    case 2:
      return {-r.sin, -r.cos};
    default:
      return {-r.cos, r.sin};
  }
}

double tangent(double x) {
  const SinCos of = sin_cos(x);
  return of.sin / of.cos;
}

double arc_tangent(double y, double x) {
  if (y == 0.0 && x >= 0.0) return 0.0;
  const double angle = atan_positive(std::abs(y), std::abs(x));
  const double turned = x < 0.0 ? kPi - angle : angle;
  return y < 0.0 ? -turned : turned;
}

}  // namespace visum::config
