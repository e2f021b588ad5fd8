// Simulation: saves the whole world at a tick border, and restores it. A saved state may come from a file, so
// every length in it is checked, and every number that an engine would see.
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "protocol/config/config.h"
#include "server/cycle/attempt.h"
#include "server/cycle/simulation.h"

namespace visum::cycle {

void Simulation::keep(recording::State& whole) const {
  whole.tick = state_.tick;
  whole.era = era_;
  whole.revision = revision_;
  whole.next_snapshot = next_snapshot_;
  save_all(state_, whole.state);
  whole.snapshots.resize(snapshots_.size());
  for (std::size_t i = 0; i < snapshots_.size(); ++i) {
    auto& kept = whole.snapshots[i];
    kept.number = snapshots_[i].number;
    kept.state.clear();
    world::save(snapshots_[i].state, kept.state);
    kept.state.insert(kept.state.end(), snapshots_[i].rest.begin(), snapshots_[i].rest.end());
  }
  whole.edits.clear();
  for (const auto& noted : edits_) whole.edits.push_back(noted.edit);
}

bool Simulation::has_bodies_of(const recording::State& whole) const {
  return std::ranges::equal(whole.edits, edits_, {}, {}, &NotedEdit::edit);
}

Outcome Simulation::take_restoring(BodyChange& change) {
  if (change.scene != scene_) return {Refusal::kWrongState, "the bodies have changed meanwhile"};
  if (auto outcome = take(change); !outcome.done()) return outcome;
  std::swap(edits_, change.noted);
  return {};
}

void Simulation::edit_bodies(const std::vector<Edit>& edits) {
  if (std::ranges::equal(edits, edits_, {}, {}, &NotedEdit::edit)) return;
  auto change = begin_restore();
  change.edits = edits;
  auto outcome = prepare(change);
  if (outcome.done()) outcome = take_restoring(change);
  if (!outcome.done()) throw std::invalid_argument(outcome.text());
}

void Simulation::restore_all(const recording::State& whole) {
  if (whole.snapshots.size() > kMaxSnapshots) throw std::out_of_range("more snapshots than are kept");
  edit_bodies(whole.edits);
  snapshots_.clear();
  std::string fault;
  for (const auto& kept : whole.snapshots) {
    auto& snapshot = snapshots_.emplace_back(Snapshot{kept.number, {}, {}});
    const auto rest = world::load(kept.state, model(), snapshot.state, fault);
    if (!fault.empty()) throw std::invalid_argument(fault);
    snapshot.rest.assign(rest.begin(), rest.end());
  }
  const auto rest = world::load(whole.state, model(), state_, fault);
  if (!fault.empty()) throw std::invalid_argument(fault);
  load_rest(rest);
  before_ = state_;
  forget_ticks();
  fault_.clear();
  era_ = whole.era;
  revision_ = whole.revision;
  next_snapshot_ = whole.next_snapshot;
}

Outcome Simulation::restore(const recording::State& whole) {
  auto* const observer = std::exchange(observer_, nullptr);
  auto* const second = std::exchange(second_observer_, nullptr);
  Outcome outcome;
  try {
    restore_all(whole);
  } catch (const std::exception& error) {
    outcome = {Refusal::kDamaged, error.what()};
    edit_bodies({});
    snapshots_.clear();
    reset();
  }
  observer_ = observer;
  second_observer_ = second;
  return outcome;
}

// Where the state does not load, the old bodies are taken back from the change, which has them.
Outcome Simulation::restore_state(const recording::State& whole, BodyChange* change) {
  const auto before = now();
  const bool same_bodies = has_bodies_of(whole);
  BodyChange own;
  if (!same_bodies && !change) {
    change = &(own = begin_restore());
    change->edits = whole.edits;
    if (auto outcome = prepare(*change); !outcome.done()) return {Refusal::kDamaged, outcome.text()};
  }
  recording::State old;
  keep(old);
  const bool was_frozen = frozen();
  const std::string fault = fault_;
  auto pulls = pulls_;  // a state does not hold whose they are
  if (!same_bodies)
    if (auto outcome = take_restoring(*change); !outcome.done()) return outcome;
  const auto outcome = attempt(Refusal::kDamaged, [&] { restore_all(whole); });
  if (!outcome.done()) {
    const auto back = attempt(Refusal::kDamaged, [&] {
      if (!same_bodies) take_back_from(*change);
      restore_all(old);
    });
    if (was_frozen) fault_ = fault;
    if (back.done()) pulls_ = std::move(pulls);
    if (!back.done()) freeze("a snapshot was restored in part: " + back.text());
    return outcome;
  }
  pulls_.clear();  // whoever held them has let go
  // The snapshots in memory go on counting, as far as they still fit.
  for (const auto& kept : old.snapshots) {
    if (!same_bodies) break;
    Snapshot snapshot{kept.number, {}, {}};
    std::string no_fault;
    const auto rest = world::load(kept.state, model(), snapshot.state, no_fault);
    snapshot.rest.assign(rest.begin(), rest.end());
    snapshots_.push_back(std::move(snapshot));
  }
  era_ = old.era + 1;
  revision_ = old.revision + (same_bodies ? 0 : 1);
  next_snapshot_ = old.next_snapshot;
  tell(before, recording::RestoreState{&whole});
  return {};
}

void Simulation::add_onlooker(std::unique_ptr<hwparts::Part> part) {
  BoundPart bound;
  bound.part = std::move(part);
  bound.onlooker = true;
  start_ports(bound);
  std::vector<std::uint32_t> numbers(parts_.size());
  for (std::size_t i = 0; i < parts_.size(); ++i)
    numbers[i] = static_cast<std::uint32_t>(i < own_parts_ ? i : i + 1);
  faults_.renumber_parts(numbers);
  parts_.insert(parts_.begin() + static_cast<std::ptrdiff_t>(own_parts_++), std::move(bound));
}

}  // namespace visum::cycle
