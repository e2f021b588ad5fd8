// The hyperbolic tangent with the same bits on every processor. The C library picks its code by processor,
// and a state hash must not depend on that. This one uses only additions, multiplications, one division and
// exact scaling.
#pragma once

namespace visum::drive {

// Within 1e-15 of the true value; odd; exactly +-1 beyond |x| = 20.
double portable_tanh(double x);

}  // namespace visum::drive
