// Contacts that hold each other. Joints may leave two links no way out of an overlap: friction holds what a
// contact drives apart, or two contacts push against each other (a wedge). No impulse helps there, and every
// method lets them grow until their rounding adds energy. Such a contact yields instead, as a stiff spring.
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/bounded.h"

namespace visum::dynamics::impulse {
namespace {

// A wedge's impulse alone would change its own velocity by more than this, m/s, and is more than so many
// times what gives the whole island the velocity that any contact needs.
constexpr double kPressed = 1.0, kAbsurd = 30.0;
// The share of what an impulse moves along all three directions by which a wedge yields. A link of 3 kg on a
// rail, in a slot that is too narrow, then meets a spring of 5e7 N/m with ticks of 1 ms.
constexpr double kWedgedGive = 0.1;

bool is_pressed(const RowBlock& block) {
  return block.kind == RowBlock::Kind::kContact && block.lambda[0] * block.K[0] > kPressed;
}

}  // namespace

void Bounded::let_wedges_yield() {
  if (moment_ == kHit) return;  // a hit must bounce exactly
  bool any = false;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    RowBlock& block = blocks_[k];
    if (block.kind != RowBlock::Kind::kContact || !plant_.touches[owners_[k].index].wedged) continue;
    if (!(block.K[0] > 0.0)) continue;
    block.give += kWedgedGive * (block.K[0] + block.K[1] + block.K[2]) / block.K[0];
    any = true;
  }
  if (any) rows_.note_gives();
}

bool Bounded::mark_wedges() {
  if (responses_.empty() || std::ranges::none_of(blocks_, is_pressed)) return false;
  double mass = 0.0;
  for (const std::size_t i : plant_.islands.bodies(island_)) mass += plant_.bodies.constants[i].mass;
  const double most = kAbsurd * mass * largest_need();
  bool any = false;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    if (!is_pressed(blocks_[k]) || !(blocks_[k].lambda[0] > most)) continue;
    Touch& touch = plant_.touches[owners_[k].index];
    if (touch.wedged || touch.foreseen) continue;  // what is foreseen must not come nearer than it may
    touch.wedged = any = true;
  }
  return any;
}

// Takes the contacts' impulses out of a copy of the velocities.
double Bounded::largest_need() {
  work_.take(system_.sweep_units);
  unpushed_.assign(velocities_.begin(), velocities_.end());
  for (const RowBlock& block : blocks_) {
    if (block.kind != RowBlock::Kind::kContact) continue;
    for (std::size_t e = 0; e < block.end_count; ++e) {
      const RowEnd& end = block.ends[e];
      double* velocity = &unpushed_[end.offset];
      for (std::size_t i = 0; i < block.dim; ++i) {
        const double* by =
            end.free ? end.MJ[i].data() : &responses_[end.response + (end.first + i) * end.size];
        for (std::size_t k = 0; k < (end.free ? 6 : end.size); ++k) velocity[k] -= by[k] * block.lambda[i];
      }
    }
  }
  double largest = 0.0;
  for (const RowBlock& block : blocks_) {
    if (block.kind != RowBlock::Kind::kContact) continue;
    double needs = block.target[0];
    for (std::size_t e = 0; e < block.end_count; ++e) {
      const RowEnd& end = block.ends[e];
      const double* velocity = &unpushed_[end.offset];
      needs -= end.free ? dot(end.J[0], velocity) : velocity[end.first];
    }
    largest = std::max(largest, std::abs(needs));
  }
  return largest;
}

}  // namespace visum::dynamics::impulse
