#include "tests/fuzz/mutator.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace visum::testing {
namespace {

constexpr int kMostChanges = 6;
// Bytes at which counts, signs and texts change their meaning, and words to replace numbers.
constexpr std::array<std::uint8_t, 10> kEdges = {0x00, 0x01, 0x7f, 0x80, 0xff, 0x20, 0x0a, 0x3a, 0x2d, 0x7d};
constexpr std::array<std::string_view, 12> kWords = {"-1",         "1e308", ".nan",  "-.inf",
                                                     "4294967296", "0",     "[]",    "{}",
                                                     "\"\"",       "${a}",  "../..", "99999999999999999999"};

// A number below `bound`, which must be at least 1.
template <typename Dice>
std::size_t below(Dice& dice, std::size_t bound) {
  return static_cast<std::size_t>(dice() % bound);
}

// A piece of [0, size), at most `most` long.
template <typename Dice>
std::pair<std::size_t, std::size_t> piece(Dice& dice, std::size_t size, std::size_t most) {
  const auto at = below(dice, size + 1);
  return {at, std::min(size - at, 1 + below(dice, most))};
}

auto offset(Input& input, std::size_t at) {
  return input.begin() + static_cast<std::ptrdiff_t>(at);
}

void insert(Input& input, std::size_t at, Input bytes) {
  input.insert(offset(input, at), bytes.begin(), bytes.end());
}

bool is_digit(std::uint8_t byte) {
  return byte >= '0' && byte <= '9';
}

// Replaces the number at or after `at`. Changes nothing if there is none.
void replace_number(Input& input, std::size_t at, std::string_view by) {
  const auto begin = std::find_if(offset(input, at), input.end(), is_digit);
  if (begin == input.end()) return;
  const auto where = begin - input.begin();
  input.erase(begin, std::find_if_not(begin, input.end(), is_digit));
  input.insert(input.begin() + where, by.begin(), by.end());
}

}  // namespace

Mutator::Mutator(std::vector<Input> corpus, std::uint64_t seed) : corpus_(std::move(corpus)), seed_(seed) {}

Input Mutator::input(std::uint64_t number) const {
  std::seed_seq mix{static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32),
                    static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(number >> 32)};
  Dice dice(mix);
  Input input = corpus_[below(dice, corpus_.size())];
  for (auto changes = 1 + below(dice, kMostChanges); changes > 0; --changes) change(input, dice);
  input.resize(std::min(input.size(), kMostBytes));
  return input;
}

void Mutator::change(Input& input, Dice& dice) const {
  const auto [at, count] = piece(dice, input.size(), 32);
  const auto kind = below(dice, 8);
  if (kind == 0) return splice(input, dice);
  if (kind == 1) {
    const auto& word = kWords[below(dice, kWords.size())];
    return insert(input, at, {word.begin(), word.end()});
  }
  if (kind == 2) return replace_number(input, at, kWords[below(dice, kWords.size())]);
  if (kind == 3) return insert(input, at, {kEdges[below(dice, kEdges.size())]});
  if (count == 0) return;
  if (kind == 4) input[at] ^= static_cast<std::uint8_t>(1u << below(dice, 8));
  if (kind == 5) input[at] = kEdges[below(dice, kEdges.size())];
  if (kind == 6) input.erase(offset(input, at), offset(input, at + count));
  if (kind == 7) insert(input, at, {offset(input, at), offset(input, at + count)});
}

// Inserts a piece of another input.
void Mutator::splice(Input& input, Dice& dice) const {
  const auto& other = corpus_[below(dice, corpus_.size())];
  const auto [from, count] = piece(dice, other.size(), other.size() + 1);
  const auto begin = other.begin() + static_cast<std::ptrdiff_t>(from);
  insert(input, below(dice, input.size() + 1), {begin, begin + static_cast<std::ptrdiff_t>(count)});
}

}  // namespace visum::testing
