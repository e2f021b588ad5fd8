// Rows that are softened where they are hard to solve, and then made firmer.
//
// Newton's method (rows_newton.cc) finds a proximal point from the last tick's impulses where few contacts
// change sides. Where many do, or repeat each other, it seldom finds a firm point, but nearly always a soft
// one. A soft point is the centre of the next point, which has less softness. A point that is not found is
// sought again with more softness. A soft point need not be exact: it may miss a share kInexact of what the
// softness before it has left.
//
// Thousands of bodies that fall on each other may need more work than a tick may take (work_budget.h), and
// what a limited step then finds is far from an answer. So free bodies that move may miss the more, the more
// work their solution has cost, and once that is a good part of a tick's, they take a point that is nearly
// firm for their answer. Where soft points end without an answer, less is enough: the methods that would
// follow take several times as long, and seldom find more.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

constexpr int kMostSoftPoints = 50, kMostFailures = 15;  // in one solution
constexpr int kMostFreePasses = 12;                      // of Newton's method, for one point
constexpr int kMostLastPoints = 4;                       // at the least softness, at its end
constexpr double kInexact = 0.3;
constexpr double kLoose = 1e4;  // times what is enough: for a firm point that is found at once
// Impulses creep from point to point where contacts repeat each other or bodies are jammed: a point leaves
// more than this share of what the one before it left with the same softness. More points are no help then,
// so from there on a solution may leave kMostSolved times what is enough, and still counts as solved.
constexpr double kCreeping = 0.5, kMostSolved = 10.0;
// How much may be left of the answer of free bodies that move: so many times what is enough where it becomes
// dear, and before and after that in proportion to the square of the work.
constexpr double kMissWhenDear = 1000.0;
// A point is given up after a few passes where none comes nearer than so many times what is enough.
constexpr double kHopeless = 1e5;
constexpr double kNearlyFirm = 0.002;    // softness of a point that may be an inexact answer
constexpr std::uint64_t kLessAtEnd = 4;  // divides the work that makes an answer dear

// Softness from point to point, as a share of the rows' responses. The first is the least; where that point
// is not found, it begins with kSoft and falls to kFirm, and from there to the least. After a point that is
// not found it falls by smaller steps, and stays where it is between kFirm and the least: to try the least
// again and again takes more work than the points that this saves.
class Softness {
 public:
  explicit Softness(double least) : least_(least), now_(least) {}

  double now() const { return now_; }
  bool is_least() const { return now_ == least_; }

  void note_found() {
    found_ = now_;
    now_ = std::min(now_, step_to(by_ * now_, now_ == kFirm ? least_ : kFirm));
    by_ = std::max(kBy, by_ * by_);
  }

  // False where not even the softest point was found.
  bool note_missing() {
    if (now_ == kMost) return false;
    if (now_ < 0.5 * found_) {
      by_ = std::sqrt(now_ / found_);
      now_ = by_ * found_;
      return true;
    }
    now_ = is_least() ? kSoft : std::min(kMost, now_ / kBy);
    by_ = kBy;
    found_ = 0.0;
    return true;
  }

 private:
  static constexpr double kSoft = 0.1, kMost = 1.0, kFirm = 1e-3, kBy = 0.1;

  // Powers of ten are rounded: what is next to the bound is the bound.
  static double step_to(double to, double bound) { return to < 1.5 * bound ? bound : to; }

  double least_, now_;
  double found_ = 0.0;  // the last one with which a point was found, if it is known to help
  double by_ = kBy;     // the next step down
};

}  // namespace

int Rows::most_soft_passes() const {
  return responses_.empty() ? kMostFreePasses : kMostNewtonPasses;
}

bool Rows::follow_soft_points(double missed, double least, double share) {
  const bool alone = responses_.empty(), moves = alone && island_->moves;
  double enough = std::max(least, share * std::max(missed, note_change()));
  double left = std::numeric_limits<double>::infinity();
  Softness softness(least_softness());
  bool softened = false, near = false, creeping = false;
  const auto allowed = [&] {
    const double of_dear = static_cast<double>(work_taken() - begun_) / static_cast<double>(island_->dear);
    const double when_dear = moves ? kMissWhenDear * of_dear * of_dear : 0.0;
    return std::max(creeping && alone ? kMostSolved : 1.0, when_dear) * enough;
  };
  double point_softness = std::numeric_limits<double>::infinity();  // of the last point that was found
  const auto will_do = [&](std::uint64_t units) {
    return moves && point_softness <= kNearlyFirm && work_taken() - begun_ > units;
  };
  int failures = 0;
  for (int point = 0; point < kMostSoftPoints && !near && failures < kMostFailures; ++point) {
    if (will_do(island_->dear)) break;
    softened = !softness.is_least();
    hold_softly(softness.now());
    move_centres(softened ? softness.now() : 0.0);
    keep(start_);
    // The first firm point is mostly the centre of another one, so it need not be exact, unless it is near.
    const bool is_first = left == std::numeric_limits<double>::infinity();
    const double loose = !softened && is_first ? kLoose : 1.0;
    const double goal = softened ? std::max(enough, kInexact * std::min(left, missed)) : enough;
    const double miss = newton({.enough = goal,
                                .most_passes = most_soft_passes(),
                                .exact = !softened,
                                .near = point_softness == softness.now(),
                                .loose = loose,
                                .hopeless = enough > least ? std::max(goal, kHopeless * enough) : kNever});
    // How large the impulses are is known only now.
    const bool found = miss <= loose * goal || (!softened && miss <= loose * share * largest_change());
    if (!found) {
      put_back(start_);
      ++failures;
      if (!softness.note_missing()) break;
      continue;
    }
    enough = std::max(least, share * note_change());
    const double before = std::exchange(left, left_by_softness());
    creeping = creeping || (point_softness == softness.now() && left > kCreeping * before);
    point_softness = softness.now();
    // Firm points find what an exact answer still misses; an inexact one stays as it is.
    near = miss <= goal && left <= allowed() && (left <= kMostSolved * enough || miss <= allowed());
    if (!near) softness.note_found();
  }
  hold_softly(least_softness());
  if (const double most = std::min(allowed(), kMostSolved * enough); near && left <= most) {
    if (!softened) return true;
    if (moves) keep(start_);
    if (follow_firm_points(enough, most)) return true;
    if (moves) put_back(start_);
  }
  move_centres(0.0);
  if (!(near && moves) && !will_do(island_->dear / kLessAtEnd)) return false;
  // Newton's last step may leave impulses a little beyond their bounds, where sweeps leave none.
  sweep_often(2, 0.0);
  island_->inexact = true;
  return false;
}

// Errors of rest add up from tick to tick, so the last points have the least softness. Each takes up what the
// one before it has left.
bool Rows::follow_firm_points(double enough, double allowed) {
  for (int point = 0; point < kMostLastPoints; ++point) {
    move_centres(0.0);
    const double miss = newton({.enough = enough, .most_passes = most_soft_passes(), .near = true});
    if (!(miss <= allowed)) return false;
    if (left_by_softness() <= allowed) return true;
  }
  move_centres(0.0);
  return false;
}

}  // namespace visum::dynamics::impulse
