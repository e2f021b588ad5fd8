// An island's rest from tick to tick: what the last tick has left of it, and what this one notes for the
// next.
#include <algorithm>

#include "server/dynamics/impulse/bounded.h"

namespace visum::dynamics::impulse {

// New contacts do not count. An island of which a part has moved has not rested.
Bounded::Rest Bounded::last_rest() const {
  Rest rest{true, kStillSteps};
  bool is_new = true;
  for (const std::size_t i : plant_.islands.touches(island_)) {
    const Touch& touch = plant_.touches[i];
    if (!touch.rested) continue;
    is_new = false;
    rest.rested = rest.rested && *touch.rested;
    rest.still = std::min(rest.still, touch.was_still);
  }
  return is_new ? Rest{} : rest;
}

// A solution may miss more than a slow belt moves: an island on it would be frozen, and never follow.
bool Bounded::is_dragged() const {
  return std::ranges::any_of(plant_.islands.touches(island_), [&](std::size_t i) {
    const Touch& touch = plant_.touches[i];
    return !touch.foreign.isZero(0.0) || !touch.foreign_turn.isZero(0.0);
  });
}

// An island that stands still rests, though its solutions may miss a little: where that is less than they
// may, nothing would ever be done about it.
void Bounded::note_rest(bool still) {
  if (moment_ == kAhead) {
    course_->rests = course_->rests && system_.rests;
    course_->frozen = course_->rests && system_.frozen;
    course_->still = still;
  }
  if (moment_ != kAfter) return;
  for (const std::size_t i : plant_.islands.touches(island_)) {
    Touch& touch = plant_.touches[i];
    touch.still = course_->still && still ? std::min(course_->still_before + 1, kStillSteps) : 0;
    touch.rested = system_.rests || touch.still > 0;
    touch.frozen = course_->frozen && system_.frozen;
  }
}

}  // namespace visum::dynamics::impulse
