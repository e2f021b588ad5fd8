// Answers near the start, for rows on mechanisms.
//
// A tick begins with the impulses of the last one. What a mechanism carries, holds or rolls on changes little
// from tick to tick: mostly the same contacts press, stick and slide. So the rows are solved from there
// before any sweep, which would take contacts off their bounds that then have to come back one by one. Where
// rows mostly stick, their bounds are followed (rows_active.cc); where they slide, or that finds nothing, the
// direction of friction turns, and Newton's method follows that (rows_newton.cc).
#include <limits>

#include "server/dynamics/impulse/friction_cone.h"
#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostNearSteps = 3;         // from bound to bound, for one proximal point
constexpr int kMostNearPasses = 10;       // of Newton's method, for one proximal point
constexpr int kMostNearPoints = 3;        // proximal points
constexpr std::size_t kSlidingShare = 4;  // much slides if one contact of so many that press does
constexpr double kOnBound = 1.0 - 1e-9;   // share of the friction radius that counts as sliding

}  // namespace

bool Rows::is_on_cone(const RowBlock& contact) {
  const Tangential held{contact.lambda[1] + contact.base[1], contact.lambda[2] + contact.base[2]};
  return !is_within_disc(held,
                         kOnBound * contact.friction * std::max(0.0, contact.lambda[0] + contact.base[0]));
}

bool Rows::slides() const {
  std::size_t sliding = 0, pressing = 0;
  for (const RowBlock& block : blocks_) {
    // Newton's method knows nothing of rolling friction.
    if (block.kind == RowBlock::Kind::kTwist) return false;
    if (block.kind != RowBlock::Kind::kContact || !(block.lambda[0] > block.low)) continue;
    ++pressing;
    if (is_on_cone(block)) ++sliding;
  }
  return sliding > 0 && kSlidingShare * sliding >= pressing;
}

// Returns false, at the start again, where it does not get there.
bool Rows::follow_near_points(double enough, const auto& settle) {
  for (int point = 0; point < kMostNearPoints && settle() <= enough; ++point) {
    if (left_by_softness() <= enough) return true;
    move_centres(0.0);
  }
  put_back(start_);
  move_centres(0.0);
  return false;
}

bool Rows::settle_near_start(double missed, double enough) {
  if (missed <= enough) return true;
  island_->changed = true;
  keep(start_);
  const auto from_bound_to_bound = [&] {
    const bool solved = solve_active(enough, kMostNearSteps);
    return solved ? largest_miss() : std::numeric_limits<double>::infinity();
  };
  if (!slides() && follow_near_points(enough, from_bound_to_bound)) return true;
  // Newton's method knows nothing of rolling friction.
  return !has(RowBlock::Kind::kTwist) && follow_near_points(enough, [&] {
    return newton({.enough = enough, .most_passes = kMostNearPasses, .near = true});
  });
}

}  // namespace visum::dynamics::impulse
