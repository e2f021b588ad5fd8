// Rows at rest: the starting impulses are the answer, and an island that stands still is frozen.
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kRestShare = 1e-3;  // share of the allowed miss that counts as rest

}  // namespace

// Rows on mechanisms are never at rest.
bool Rows::rest_at_start(double least, double share, double rest) {
  island_->frozen = false;
  if (rest == 0.0 || !responses_.empty()) return false;
  const double missed = largest_miss(), change = note_change();
  island_->frozen = missed <= std::max(least, share * change) && is_still(island_->freezes_below);
  if (!island_->frozen) return missed <= rest * std::max(least, kRestShare * share * change);
  for (std::size_t i = 0; i < velocities_.size(); ++i) velocities_[i] = island_->still[i % 6];
  return island_->changed = true;
}

// Newton's method knows nothing of rolling friction.
void Rows::polish(double least) {
  const double missed = largest_miss();
  if (missed <= least || has(RowBlock::Kind::kTwist)) return;
  keep(start_);
  if (follow_firm_points(least, least) || largest_miss() < missed)
    island_->changed = true;
  else
    put_back(start_);
}

bool Rows::is_still(double limit) const {
  if (limit == 0.0) return false;
  for (std::size_t i = 0; i < velocities_.size(); ++i)
    if (!(std::abs(velocities_[i] - island_->still[i % 6]) <= limit)) return false;
  return true;
}

}  // namespace visum::dynamics::impulse
