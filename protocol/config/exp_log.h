// Own exponential and natural logarithm, for the reason that trig.h gives: the C library's last bits depend
// on the processor. Accurate to about 1 unit in the last place. Polynomials and reduction follow fdlibm (Sun
// Microsystems, 1993): e_exp.c, e_log.c. Pure functions, any thread.
#pragma once

namespace visum::config {

// 0 below -745, infinity above 709.8. NaN for NaN.
double exponential(double x);
// For normal numbers above 0. NaN for all others.
double logarithm(double x);

}  // namespace visum::config
