// Islands: groups of bodies that joints, springs and contacts connect. What happens in one island does not
// depend on any other, so each is solved by itself, to its own end. Bodies that do not move, or that another
// engine moves, connect nothing.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "server/dynamics/engine.h"
#include "server/world/disjoint_sets.h"

namespace visum::dynamics::impulse {

struct Plant;

// They follow from the tick's contacts and wrenches alone, so a restored world has the same islands.
// They are numbered in the order of their first bodies. A body that nothing is connected to, and on which no
// wrench acts, is in no island. Plant owns it; tick's thread. Allocates only while it grows.
class Islands {
 public:
  Islands() {}                           // none
  explicit Islands(const Plant& plant);  // joins what joints and springs connect
  // Joins what the tick's contacts connect, too.
  void find(const Plant& plant, std::span<const Wrench> wrenches);

  std::size_t size() const { return count_; }
  // Their members, as indices into the plant's lists, and into the wrenches, ascending. Contacts that sleep
  // are left out.
  std::span<const std::size_t> bodies(std::size_t island) const { return bodies_.of(island); }
  std::span<const std::size_t> mechanisms(std::size_t island) const { return mechanisms_.of(island); }
  std::span<const std::size_t> springs(std::size_t island) const { return springs_.of(island); }
  std::span<const std::size_t> touches(std::size_t island) const { return touches_.of(island); }
  std::span<const std::size_t> wrenches(std::size_t island) const { return wrenches_.of(island); }

 private:
  // Things in the order of their islands, and where each island's begin.
  struct Members {
    std::vector<std::size_t> things, first;
    std::span<const std::size_t> of(std::size_t island) const {
      return std::span(things).subspan(first[island], first[island + 1] - first[island]);
    }
  };
  // Numbers the islands and lists their members.
  void list(const Plant& plant, std::span<const Wrench> wrenches);
  // Lists `count` things; body_of() says a body of each, or -1 for one that is left out.
  template <typename BodyOf>
  void list(Members& members, std::size_t count, BodyOf body_of);

  // By touch of the last tick and of this one, the numbers of the two bodies that it joins; -1 if it sleeps.
  std::vector<std::array<int, 2>> last_pairs_, pairs_;
  world::DisjointSets joined_, sets_;  // of bodies: by joints and springs; by contacts, too
  std::vector<std::size_t> number_;    // by body that leads a set: the island's number
  std::size_t count_ = 0;
  Members bodies_, mechanisms_, springs_, touches_, wrenches_;
};

}  // namespace visum::dynamics::impulse
