// The random numbers of one sensor. Each sensor has a stream of its own, so that adding one changes no other
// sensor's noise. The bits are the same on every machine: it uses only basic arithmetic and the square root,
// which IEEE 754 fixes.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "hwparts/state_archive.h"

namespace visum::sensors {

class Random {
 public:
  // The stream of the given name in a world with the given seed.
  Random(std::uint64_t seed, std::string_view name);

  double uniform();  // 0 <= u < 1
  double normal();   // mean 0, standard deviation 1

  void save(hwparts::StateWriter& to) const;
  void load(hwparts::StateReader& from);

 private:
  std::uint64_t next();

  std::array<std::uint64_t, 4> words_;  // never all zero
};

// ln(x) for a finite x > 0, to a few units in the last place.
double portable_log(double x);

}  // namespace visum::sensors
