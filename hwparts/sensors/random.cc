#include "hwparts/sensors/random.h"

#include <bit>
#include <cmath>

namespace visum::sensors {
namespace {

// FNV-1a, 64 bits (Fowler, Noll, Vo).
std::uint64_t hash_of(std::string_view name) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  for (const char letter : name)
    hash = (hash ^ static_cast<unsigned char>(letter)) * std::uint64_t{0x100000001B3u};
  return hash;
}

}  // namespace

// Makes the four words from one number by SplitMix64 (Steele et al. 2014), as xoshiro's authors advise.
Random::Random(std::uint64_t seed, std::string_view name) {
  std::uint64_t state = seed ^ hash_of(name);
  for (auto& word : words_) {
    state += 0x9E3779B97F4A7C15u;
    word = (state ^ (state >> 30)) * 0xBF58476D1CE4E5B9u;
    word = (word ^ (word >> 27)) * 0x94D049BB133111EBu;
    word ^= word >> 31;
  }
}

// xoshiro256** (Blackman, Vigna 2018).
std::uint64_t Random::next() {
  const std::uint64_t result = std::rotl(words_[1] * 5, 7) * 9;
  const std::uint64_t shifted = words_[1] << 17;
  words_[2] ^= words_[0];
  words_[3] ^= words_[1];
  words_[1] ^= words_[2];
  words_[0] ^= words_[3];
  words_[2] ^= shifted;
  words_[3] = std::rotl(words_[3], 45);
  return result;
}

double Random::uniform() {
  return static_cast<double>(next() >> 11) * 0x1.0p-53;
}

// Marsaglia's polar method (1964); the second number of each pair is not kept.
double Random::normal() {
  for (;;) {
    const double u = 2.0 * uniform() - 1.0, v = 2.0 * uniform() - 1.0;
    const double s = u * u + v * v;
    if (s > 0.0 && s < 1.0) return u * std::sqrt(-2.0 * portable_log(s) / s);
  }
}

void Random::save(hwparts::StateWriter& to) const {
  for (const auto word : words_) to.put(word);
}

void Random::load(hwparts::StateReader& from) {
  for (auto& word : words_) from.get(word);
}

// With x = m 2^e and m in [1/sqrt 2, sqrt 2): ln x = e ln 2 + ln m, and ln m = 2 artanh((m - 1) / (m + 1)) by
// its series. The first term left out is below 1e-17.
double portable_log(double x) {
  constexpr double kLn2 = 0.69314718055994530942;
  constexpr double kSqrtHalf = 0.70710678118654752440;
  constexpr int kLastPower = 21;
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < kSqrtHalf) {
    m *= 2.0;
    --exponent;
  }
  const double s = (m - 1.0) / (m + 1.0);
  const double square = s * s;
  double sum = 0.0;
  for (int power = kLastPower; power >= 1; power -= 2) sum = sum * square + 1.0 / power;
  return exponent * kLn2 + 2.0 * s * sum;
}

}  // namespace visum::sensors
