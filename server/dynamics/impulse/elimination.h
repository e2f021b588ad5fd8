// Finds an order in which to eliminate the unknowns of a sparse system, and the entries that this makes. The
// next unknown is always the one with the fewest neighbours left (minimum degree; George, Liu, The evolution
// of the minimum degree ordering algorithm, SIAM Review 31, 1989). The bodies of a wall then take a fifth of
// the work that they take in the order in which they touch.
//
// A position is a place in that order. Column k has the entries below the diagonal that position k leaves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace visum::dynamics::impulse {

// Owned by BodyFactor, used on one thread. Call start(), connect() for each pair, then find(). The result
// follows from these calls alone; the last one is kept, and given again for the same pairs.
class Elimination {
 public:
  void start(std::size_t count);  // of unknowns
  void connect(std::size_t a, std::size_t b);
  // Takes about count²/2 steps. False, without a result, if there would be more entries than that.
  bool find(std::size_t most_entries);

  std::size_t count() const { return order_.size(); }
  std::size_t entries() const { return rows_.size(); }           // below the diagonal
  std::span<const std::size_t> order() const { return order_; }  // by position: the unknown
  std::size_t position(std::size_t unknown) const { return position_[unknown]; }
  // By position: where its column begins in rows(); one more at the end.
  std::span<const std::size_t> begins() const { return begins_; }
  std::span<const std::size_t> rows() const { return rows_; }  // positions, ascending in each column
  // Where the entry of two positions is in rows(); `row` is the later one.
  std::size_t entry(std::size_t row, std::size_t column) const;
  std::size_t products(bool symmetric) const;  // of two entries, in a factor

 private:
  std::span<std::uint64_t> neighbours(std::size_t unknown) {
    return std::span(neighbours_).subspan(unknown * words_, words_);
  }
  // Takes the unknown out, and connects all of its neighbours to each other.
  void eliminate(std::size_t unknown);

  using Pair = std::pair<std::size_t, std::size_t>;
  std::vector<Pair> pairs_, found_pairs_;  // as connected; those of the last find()
  std::size_t count_ = 0, found_count_ = 0;
  std::size_t found_most_ = 0;
  bool fits_ = false;      // what the last find() said
  std::size_t words_ = 0;  // of a set of unknowns, a bit for each
  std::vector<std::uint64_t> neighbours_;
  std::vector<std::size_t> degree_, left_;  // by unknown; the unknowns still to come, ascending
  std::vector<std::size_t> order_, position_, begins_, rows_;
};

}  // namespace visum::dynamics::impulse
