// Sine, cosine and arc tangent of our own: the C library chooses other code on other processors (with and
// without fused multiply-add), and gives other bits. Within 1 unit in the last place or so. Polynomials and
// reduction: fdlibm (Sun Microsystems, 1993), k_sin.c, k_cos.c, s_atan.c.
#pragma once

namespace visum::config {

struct SinCos {
  double sin, cos;
};

inline constexpr double kQuarterPi = 0.78539816339744830962;

// |x| up to 1e6; beyond it, and for what is no number, NaN.
SinCos sin_cos_large(double x);
double tangent(double x);                // likewise
double arc_tangent(double y, double x);  // as std::atan2

// For |x| <= pi/4.
inline SinCos sin_cos_small(double x) {
  const double z = x * x;
  const double s = -1.66666666666666324348e-01 +
                   z * (8.33333333332248946124e-03 +
                        z * (-1.98412698298579493134e-04 +
                             z * (2.75573137070700676789e-06 +
                                  z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))));
  const double c = 4.16666666666666019037e-02 +
                   z * (-1.38888888888741095749e-03 +
                        z * (2.48015872894767294178e-05 +
                             z * (-2.75573143513906633035e-07 +
                                  z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))));
  return {x + x * z * s, 1.0 - (0.5 * z - z * z * c)};
}

// Likewise.
inline SinCos sin_cos(double x) {
  return x <= kQuarterPi && x >= -kQuarterPi ? sin_cos_small(x) : sin_cos_large(x);
}

}  // namespace visum::config
