// Finds the shapes that are near each other: a sweep over their widened boxes (near_W), sorted along the axis
// on which they spread most. Planes meet every shape whose widened box reaches below them. FCL's dynamic tree
// was tried, too. For boxes piled on a plane it takes as long with 900 and with 10,000 shapes (0.16 ms, 4.8
// ms), twice as long with 100, and four times as long for an arm with 26 (2 us to 0.5 us).
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "server/collision/shapes.h"

namespace visum::collision {

using BodyPair = std::pair<world::BodyId, world::BodyId>;
using IndexPair = std::pair<std::uint32_t, std::uint32_t>;

// CollisionStage owns it; tick's thread. Nothing fails.
class BroadPhase {
 public:
  // `never`: pairs of bodies that never collide, sorted, a < b.
  BroadPhase(const std::vector<PreparedShape>& shapes, std::vector<BodyPair> never);

  // Returns pairs of indices into `shapes`, first < second, sorted. They are valid until the next call. Does
  // not allocate once warm.
  const std::vector<IndexPair>& find(const std::vector<PreparedShape>& shapes);

  // False for shapes of one body, of two fixed bodies, and of excluded pairs.
  bool may_collide(const PreparedShape& a, const PreparedShape& b) const;

 private:
  // Pairs of shapes with boxes, and pairs with a plane.
  void sweep(const std::vector<PreparedShape>& shapes);
  void meet_planes(const std::vector<PreparedShape>& shapes);

  std::vector<BodyPair> never_;
  std::vector<std::uint32_t> planes_, boxed_;
  std::vector<IndexPair> pairs_;
};

// How far apart the boxes of two shapes are, along the best of the world's axes, m. For a plane: how far
// above it the other shape's box is. Below 0, and for two boxes at 0, the shapes may touch.
double gap_of_boxes(const PreparedShape& a, const PreparedShape& b);

// The pairs of `no_collision` and the pairs that joints hold together (springs do not), sorted.
std::vector<BodyPair> pairs_that_never_collide(const world::WorldModel& model);

}  // namespace visum::collision
