#include "protocol/config/trig.h"

#include <cmath>
#include <limits>

namespace visum::config {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTwoByPi = 6.36619772367581382433e-01;
constexpr double kHalfPiHigh = 1.57079632673412561417e+00;  // 33 bits, so that n times it is exact
constexpr double kHalfPiLow = 6.07710050650619224932e-11;
constexpr double kMost = 1e6;  // n times kHalfPiHigh is exact up to here
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

// x - atan(x) for |x| <= 7/16.
double atan_rest(double x) {
  const double z = x * x;
  double sum = 0.0;
  for (int i = 10; i >= 0; --i) sum = kAtan[i] + z * sum;
  return x * z * sum;
}

double atan_positive(double x) {
  if (x < 0.4375) return x - atan_rest(x);
  int part = 3;
  double t = -1.0 / x;
  if (x < 0.6875) {
    part = 0;
    t = (2.0 * x - 1.0) / (2.0 + x);
  } else if (x < 1.1875) {
    part = 1;
    t = (x - 1.0) / (x + 1.0);
  } else if (x < 2.4375) {
    part = 2;
    t = (x - 1.5) / (1.0 + 1.5 * x);
  }
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
  const double angle = x == 0.0 ? 0.5 * kPi : atan_positive(std::abs(y / x));
  const double turned = x < 0.0 ? kPi - angle : angle;
  return y < 0.0 ? -turned : turned;
}

}  // namespace visum::config
