// The kernels for processors with AVX2: the same source, compiled with -mavx2.
#if defined(__AVX2__)
#include "server/dynamics/impulse/lanes/all_kernels.h"

namespace visum::dynamics::impulse {
namespace {
const Kernels kOfAvx2 = make_kernels("x86-64-v3");
}  // namespace
extern const Kernels* const kWideKernels;
const Kernels* const kWideKernels = &kOfAvx2;
}  // namespace visum::dynamics::impulse
#else
#include "server/dynamics/impulse/lanes/kernels.h"

namespace visum::dynamics::impulse {
const Kernels* const kWideKernels = nullptr;
}  // namespace visum::dynamics::impulse
#endif
