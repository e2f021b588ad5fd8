// The stage `collision: fcl`: FCL's broad phase (its sweep and prune of boxes) and FCL's narrow phase say
// which convex solids touch, and in which direction they overlap. Contact points follow from that direction
// as in the stage of our own (manifold.h).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "server/collision/broad_phase.h"
#include "server/collision/penetration.h"

namespace visum::collision {

// CollisionStage owns it; tick's thread. FCL allocates in each call. Nothing throws: where FCL gives up on a
// pair, touch() says so.
class FclStage {
 public:
  explicit FclStage(const std::vector<PreparedShape>& shapes);
  ~FclStage();

  // Pairs of shapes whose boxes meet, first < second, sorted; all shapes must be placed. The result depends
  // on the places alone.
  const std::vector<IndexPair>& find_pairs(const std::vector<PreparedShape>& shapes, const BroadPhase& broad);

  struct Touch {
    bool gave_up = false;  // FCL has failed
    std::optional<Direction> direction;
  };
  // Two convex solids: neither plane nor mesh.
  Touch touch(const std::vector<PreparedShape>& shapes, std::size_t a, std::size_t b);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::collision
