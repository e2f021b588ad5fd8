// Disjoint sets of the numbers 0 to n-1 (union-find). The leader of a set is its smallest member, so the
// order of the joins does not matter.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace visum::world {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size = 0) : leader_(size) { separate(); }

  void separate() { std::iota(leader_.begin(), leader_.end(), std::size_t{0}); }  // each number alone
  void separate(std::size_t size) {                                               // likewise, of another size
    leader_.resize(size);
    separate();
  }
  void join(std::size_t a, std::size_t b) {
    a = leader(a);
    b = leader(b);
    leader_[std::max(a, b)] = std::min(a, b);
  }
  std::size_t leader(std::size_t i) {
    while (leader_[i] != i) i = leader_[i] = leader_[leader_[i]];
    return i;
  }

 private:
  std::vector<std::size_t> leader_;  // by number: a smaller or equal one of its set
};

}  // namespace visum::world
