#include "server/dynamics/impulse/elimination.h"

#include <algorithm>
#include <bit>

namespace visum::dynamics::impulse {
namespace {

constexpr std::size_t kBits = 64;

// Calls `with` for each member of a set, ascending.
template <typename With>
void for_each(std::span<const std::uint64_t> set, With with) {
  for (std::size_t word = 0; word < set.size(); ++word)
    for (std::uint64_t rest = set[word]; rest != 0; rest &= rest - 1)
      with(kBits * word + static_cast<std::size_t>(std::countr_zero(rest)));
}

void put(std::span<std::uint64_t> set, std::size_t member) {
  set[member / kBits] |= std::uint64_t{1} << member % kBits;
}

void drop(std::span<std::uint64_t> set, std::size_t member) {
  set[member / kBits] &= ~(std::uint64_t{1} << member % kBits);
}

std::size_t size_of(std::span<const std::uint64_t> set) {
  std::size_t size = 0;
  for (const std::uint64_t word : set) size += static_cast<std::size_t>(std::popcount(word));
  return size;
}

}  // namespace

void Elimination::start(std::size_t count) {
  count_ = count;
  pairs_.clear();
}

void Elimination::connect(std::size_t a, std::size_t b) {
  // The contacts of two bodies come one after the other.
  if (a != b && (pairs_.empty() || pairs_.back() != Pair{a, b})) pairs_.emplace_back(a, b);
}

bool Elimination::find(std::size_t most_entries) {
  if (count_ == found_count_ && most_entries == found_most_ && pairs_ == found_pairs_) return fits_;
  found_count_ = count_;
  found_most_ = most_entries;
  found_pairs_ = pairs_;
  fits_ = false;
  words_ = (count_ + kBits - 1) / kBits;
  neighbours_.assign(count_ * words_, 0);
  for (const auto& [a, b] : pairs_) {
    put(neighbours(a), b);
    put(neighbours(b), a);
  }
  degree_.resize(count_);
  left_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    degree_[i] = size_of(neighbours(i));
    left_[i] = i;
  }
  order_.clear();
  position_.resize(count_);
  begins_.assign(1, 0);
  rows_.clear();
  while (!left_.empty()) {
    // The lowest number comes first among equals.
    const auto next = std::ranges::min_element(left_, {}, [this](std::size_t i) { return degree_[i]; });
    eliminate(*next);
    left_.erase(next);
    if (rows_.size() > most_entries) return false;
  }
  // Entries were noted by unknown so far; from here on they are positions.
  for (std::size_t k = 0; k < count_; ++k) {
    const auto column = std::span(rows_).subspan(begins_[k], begins_[k + 1] - begins_[k]);
    for (std::size_t& row : column) row = position_[row];
    std::ranges::sort(column);
  }
  fits_ = true;
  return true;
}

void Elimination::eliminate(std::size_t unknown) {
  const std::span<std::uint64_t> around = neighbours(unknown);
  position_[unknown] = order_.size();
  order_.push_back(unknown);
  for_each(around, [&](std::size_t i) {
    rows_.push_back(i);
    const std::span<std::uint64_t> own = neighbours(i);
    for (std::size_t word = 0; word < words_; ++word) own[word] |= around[word];
    drop(own, i);
    drop(own, unknown);
    degree_[i] = size_of(own);
  });
  begins_.push_back(rows_.size());
}

std::size_t Elimination::entry(std::size_t row, std::size_t column) const {
  const auto first = rows_.begin() + static_cast<std::ptrdiff_t>(begins_[column]);
  const auto last = rows_.begin() + static_cast<std::ptrdiff_t>(begins_[column + 1]);
  return static_cast<std::size_t>(std::lower_bound(first, last, row) - rows_.begin());
}

// One for each entry, and for each two of a column; those off the diagonal twice where both halves are made.
std::size_t Elimination::products(bool symmetric) const {
  std::size_t products = 0;
  for (std::size_t k = 0; k < count(); ++k) {
    const std::size_t n = begins_[k + 1] - begins_[k];
    products += n + (symmetric ? n * (n + 1) / 2 : n * n);
  }
  return products;
}

}  // namespace visum::dynamics::impulse
