// Random numbers of one sensor: a stream of its own, so that one sensor more changes no other's noise. The
// same bits on every machine: nothing but basic arithmetic and the square root, which IEEE 754 fixes.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "hwparts/state_archive.h"

namespace visum::sensors {

class Random {
 public:
  // The stream of this name in a world of this seed.
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
