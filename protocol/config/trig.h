// Own sine, cosine and arc tangent, because the C library's give other bits on other processors: it chooses
// code with or without fused multiply-add. Accurate to about 1 unit in the last place. Polynomials and
// reduction follow fdlibm (Sun Microsystems, 1993): k_sin.c, k_cos.c, s_atan.c. Pure functions, any thread.
#pragma once

namespace visum::config {

struct SinCos {
  double sin, cos;
};

inline constexpr double kQuarterPi = 0.78539816339744830962;

// For |x| up to 1e6. NaN beyond it, and for NaN.
SinCos sin_cos_large(double x);
double tangent(double x);                // the same range as sin_cos_large()
double arc_tangent(double y, double x);  // as std::atan2

// sin x = x + x z S(z),  cos x = 1 - (z/2 - z^2 C(z)),  z = x^2, |x| <= pi/4: the coefficients of S and C.
inline constexpr double kSine[] = {-1.66666666666666324348e-01, 8.33333333332248946124e-03,
                                   -1.98412698298579493134e-04, 2.75573137070700676789e-06,
                                   -2.50507602534068634195e-08, 1.58969099521155010221e-10};
inline constexpr double kCosine[] = {4.16666666666666019037e-02, -1.38888888888741095749e-03,
                                     2.48015872894767294178e-05, -2.75573143513906633035e-07,
                                     2.08757232129817482790e-09, -1.13596475577881948265e-11};

// For |x| <= pi/4.
inline SinCos sin_cos_small(double x) {
  const double z = x * x;
  const auto& S = kSine;
  const auto& C = kCosine;
  const double s = S[0] + z * (S[1] + z * (S[2] + z * (S[3] + z * (S[4] + z * S[5]))));
  const double c = C[0] + z * (C[1] + z * (C[2] + z * (C[3] + z * (C[4] + z * C[5]))));
  return {x + x * z * s, 1.0 - (0.5 * z - z * z * c)};
}

// For |x| up to 1e6, as sin_cos_large().
inline SinCos sin_cos(double x) {
  return x <= kQuarterPi && x >= -kQuarterPi ? sin_cos_small(x) : sin_cos_large(x);
}

}  // namespace visum::config
