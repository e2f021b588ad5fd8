#include "server/dynamics/impulse/lanes/kernels.h"

#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/config/unknown_name.h"

namespace visum::dynamics::impulse {
namespace {

// True if the AVX2 kernels exist and this processor has AVX2.
bool has_wide() {
#if defined(__x86_64__)
  return kWideKernels != nullptr && __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

const Kernels& choose() {
  const char* wanted = std::getenv("VISUM_KERNELS");
  if (wanted == nullptr || *wanted == '\0') return has_wide() ? *kWideKernels : kBaselineKernels;
  if (std::string(wanted) == kBaselineKernels.build) return kBaselineKernels;
  if (has_wide() && std::string(wanted) == kWideKernels->build) return *kWideKernels;
  std::vector<std::string> known{kBaselineKernels.build};
  if (has_wide()) known.emplace_back(kWideKernels->build);
  throw std::runtime_error("environment variable VISUM_KERNELS: " +
                           config::unknown_name("build", wanted, known));
}

}  // namespace

const Kernels& kernels() {
  static const Kernels& chosen = choose();
  return chosen;
}

}  // namespace visum::dynamics::impulse
