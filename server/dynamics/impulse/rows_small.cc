// The active rows' system where rows are few, with full matrices (small_system.h).
#include <array>

#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

// Rows, whether active or not. One ragdoll takes as long with 72 as with 120, and 1.7 times that with 48.
constexpr std::size_t kMostSmall = 96;

}  // namespace

// True if all rows are those of one mechanism, in its order: then they respond as its W says.
bool Rows::is_one_mechanism() const {
  const RowEnd& first = blocks_.front().ends[0];
  std::size_t next = 0;
  for (const RowBlock& block : blocks_) {
    const RowEnd& end = block.ends[0];
    if (block.end_count != 1 || end.free || !meet(end, first) || end.first != next) return false;
    next += block.dim;
  }
  return next == first.size;
}

bool Rows::prepare_small() {
  if (has_places_) return !places_.empty();
  has_places_ = true;
  places_.clear();
  std::size_t count = 0;
  for (const RowBlock& block : blocks_) count += block.dim;
  if (count > kMostSmall) return false;
  count_work(kPerResponse * count * count / 2);
  small_.start(count);
  for (std::size_t next = 0; const RowBlock& block : blocks_) {
    places_.push_back(next);
    next += block.dim;
  }
  if (is_one_mechanism()) {
    const std::span<const double> W = responses_.subspan(blocks_.front().ends[0].response, count * count);
    for (std::size_t i = 0; i < count; ++i) small_.set_responses(i, W.subspan(i * count, count));
    return true;
  }
  std::array<double, 9> memory;
  for (std::size_t a = 0; a < blocks_.size(); ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      if (!meet(blocks_[a], blocks_[b])) continue;
      const Responses of = find_responses(blocks_[a], blocks_[b], memory.data());
      for (std::size_t r = 0; r < blocks_[a].dim; ++r)
        for (std::size_t s = 0; s < blocks_[b].dim; ++s)
          small_.set_response(places_[a] + r, places_[b] + s, of(r, s));
    }
  return true;
}

bool Rows::factor_small() {
  small_.clear();
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Row& row = active_[i];
    const bool across = row.row == kAcross;
    const std::array<double, 2>& along = across ? row.across : row.drag;
    small_.add({.at = places_[row.block] + (across ? 1 : row.row),
                .kind = across        ? SmallRow::Kind::kAcross
                        : row.drags() ? SmallRow::Kind::kDrags
                                      : SmallRow::Kind::kPlain,
                .along = {along[0], along[1]},
                .softness = active_softness_[i]});
  }
  count_work(active_.size() * active_.size() * active_.size() / 3 / WorkBudget::kMultiplications);
  return small_.factor();
}

}  // namespace visum::dynamics::impulse
