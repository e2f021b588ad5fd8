// Reads lines "Y X" of doubles in hexadecimal, and prints the bits that protocol/config/trig.h makes of them:
// "sin(Y) cos(Y) tan(Y) atan2(Y,X)".
#include <cinttypes>
#include <cstdio>
#include <cstring>

#include "protocol/config/trig.h"

namespace {

// All NaN are one.
std::uint64_t bits_of(double number) {
  if (number != number) return 0x7ff8000000000000;
  std::uint64_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  return bits;
}

}  // namespace

int main() {
  using namespace visum::config;
  double y = 0.0, x = 0.0;
  while (std::scanf("%la %la", &y, &x) == 2) {
    const SinCos of = sin_cos(y);
    std::printf("%016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 "\n", bits_of(of.sin),
                bits_of(of.cos), bits_of(tangent(y)), bits_of(arc_tangent(y, x)));
  }
}
