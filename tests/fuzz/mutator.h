// Makes new inputs for a fuzz target, each from an input of the corpus by a few random changes. An input is a
// function of corpus, seed and number. It does not use coverage; libFuzzer does that (tests/fuzz/run).
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace visum::testing {

using Input = std::vector<std::uint8_t>;

class Mutator {
 public:
  static constexpr std::size_t kMostBytes = 16u << 10;  // of a new input

  // `corpus` must hold at least one input.
  Mutator(std::vector<Input> corpus, std::uint64_t seed);

  Input input(std::uint64_t number) const;

 private:
  using Dice = std::mt19937_64;
  void change(Input& input, Dice& dice) const;
  void splice(Input& input, Dice& dice) const;

  const std::vector<Input> corpus_;
  const std::uint64_t seed_;
};

}  // namespace visum::testing
