// The kernels for every processor.
#include "server/dynamics/impulse/lanes/all_kernels.h"

namespace visum::dynamics::impulse {
const Kernels kBaselineKernels = make_kernels("x86-64");
}  // namespace visum::dynamics::impulse
