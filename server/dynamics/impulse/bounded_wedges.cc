// Contacts that hold each other. Joints may leave two links no way out of an overlap: friction holds what a
// contact drives apart, or two contacts push against each other (a wedge). No impulse helps there, and every
// method lets them grow until their rounding adds energy. Such a contact yields instead, as a stiff spring.
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/bounded.h"

namespace visum::dynamics::impulse {
namespace {

// A wedge's impulse alone would change its own velocity by more than this (m/s), and by so many times what
// any contact needs. In robots that fall on themselves nearly all wedges have more than 1000 times that, and
// legs that land less than 100 times.
constexpr double kPressed = 1.0, kAbsurd = 300.0;
// The share of what an impulse moves along all three directions by which a wedge yields. With 0.1 (m/s)/(N·s)
// along these and ticks of 1 ms it is a spring of some 4e7 N/m.
constexpr double kWedgedGive = 0.1;

bool is_pressed(const RowBlock& block, double most) {
  return block.kind == RowBlock::Kind::kContact && block.lambda[0] * block.K[0] > most;
}

}  // namespace

bool Bounded::lets_wedges_yield() {
  // Joint after joint, impulses are far off until the joints have closed; and a hit must bounce exactly.
  if (responses_.empty() || moment_ == kHit || course_->gently || apart_) return false;
  if (plant_.setting.solver == "iterate") return false;
  const auto is_suspect = [](const RowBlock& block) { return is_pressed(block, kPressed); };
  if (std::ranges::none_of(blocks_, is_suspect)) return false;
  const double most = std::max(kPressed, kAbsurd * largest_need());
  bool any = false;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    RowBlock& block = blocks_[k];
    // A foreseen contact must not come nearer than it may.
    if (!is_pressed(block, most) || block.give != kGive || plant_.touches[owners_[k].index].foreseen)
      continue;
    block.give += kWedgedGive * (block.K[0] + block.K[1] + block.K[2]) / block.K[0];
    any = true;
  }
  if (!any) return false;
  for (std::size_t k = 0; k < blocks_.size(); ++k) blocks_[k].lambda = before_[k];
  rows_.note_gives();
  return true;
}

// Takes all impulses out of a copy of the velocities.
double Bounded::largest_need() {
  work_.take(system_.sweep_units);
  unpushed_.assign(velocities_.begin(), velocities_.end());
  for (const RowBlock& block : blocks_) {
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
    for (std::size_t i = 0; i < block.dim; ++i) {
      double needs = block.target[i];
      for (std::size_t e = 0; e < block.end_count; ++e) {
        const RowEnd& end = block.ends[e];
        const double* velocity = &unpushed_[end.offset];
        needs -= end.free ? dot(end.J[i], velocity) : velocity[end.first + i];
      }
      largest = std::max(largest, std::abs(needs));
    }
  }
  return largest;
}

}  // namespace visum::dynamics::impulse
