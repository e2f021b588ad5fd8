#include "server/dynamics/impulse/standing.h"

#include <algorithm>
#include <utility>

#include "server/dynamics/impulse/island_stepper.h"
#include "server/world/same_bits.h"

namespace visum::dynamics::impulse {
namespace {

using collision::Contact;
using world::are_same_bits;

// All that the engine reads of a contact.
bool are_given_alike(const Contact& a, const Contact& b) {
  return key_of(a) == key_of(b) && a.body_a == b.body_a && a.body_b == b.body_b &&
         are_same_bits(a.p_W, b.p_W) && are_same_bits(a.normal_W, b.normal_W) &&
         are_same_bits(a.to_b_W, b.to_b_W) && are_same_bits(a.depth, b.depth) &&
         are_same_bits(a.friction, b.friction) && are_same_bits(a.restitution, b.restitution) &&
         are_same_bits(a.rolling_friction, b.rolling_friction) &&
         are_same_bits(a.torsional_friction, b.torsional_friction);
}

// Body i in two lists.
bool is_alike(const auto& a, const auto& b, std::size_t i) {
  return are_same_bits(a.x[i], b.x[i]) && are_same_bits(a.q_WB[i], b.q_WB[i]) &&
         are_same_bits(a.v[i], b.v[i]) && are_same_bits(a.w[i], b.w[i]);
}

}  // namespace

void Standing::make_room() {
  const std::size_t touches = plant_.touches.capacity(), islands = plant_.bodies.size();
  if (next_island_.capacity() >= touches) return;
  for (auto* list : {&kept_, &next_}) list->reserve(touches);
  for (auto* list : {&match_, &next_island_}) list->reserve(touches);
  for (auto* list : {&kept_islands_, &next_islands_}) list->reserve(islands);
  repeats_.reserve(islands);
  stays_.reserve(islands);
}

void Standing::find_none() {
  notes_ = any_ = false;
  kept_.clear();
}

void Standing::find(double h, std::span<const Contact> contacts, const WarmStart& warm_start) {
  if (!are_same_bits(h, h_)) kept_.clear();
  h_ = h;
  notes_ = true;
  any_ = false;
  plant_.bodies.keep(began_);
  make_room();
  if (kept_.empty()) return;
  // Contacts are sorted, so one pass finds the pairs.
  match_.assign(plant_.touches.size(), kNone);
  for (std::size_t i = 0, k = 0; i < plant_.touches.size(); ++i) {
    const TouchEnds& touch = plant_.touches[i];
    const Contact& contact = contacts[touch.contact];
    while (k < kept_.size() && key_of(kept_[k].contact) < key_of(contact)) ++k;
    if (k == kept_.size()) break;
    if (touch.record != TouchEnds::kNew && are_given_alike(kept_[k].contact, contact) &&
        std::ranges::equal(warm_start.record(touch), kept_[k].record))
      match_[i] = k;
  }
  repeats_.resize(plant_.islands.size());
  for (std::size_t island = 0; island < repeats_.size(); ++island) {
    repeats_[island] = find_repeated(island);
    if (repeats_[island] == kNone) continue;
    any_ = true;
    for (const std::size_t i : plant_.islands.touches(island)) plant_.touches[i].stands = true;
  }
}

std::size_t Standing::find_repeated(std::size_t island) const {
  const std::span<const std::size_t> touches = plant_.islands.touches(island);
  if (!has_contacts_only(island) || match_[touches.front()] == kNone) return kNone;
  const std::size_t found = kept_[match_[touches.front()]].island;
  // Contacts that connect these bodies did so in the last tick: all that match are of one island.
  const bool repeats = kept_islands_[found].touches == touches.size() &&
                       std::ranges::all_of(touches, [&](std::size_t i) { return match_[i] != kNone; }) &&
                       std::ranges::all_of(plant_.islands.bodies(island),
                                           [&](std::size_t i) { return is_alike(began_, last_began_, i); });
  return repeats ? found : kNone;
}

bool Standing::has_contacts_only(std::size_t island) const {
  const Islands& of = plant_.islands;
  return !of.touches(island).empty() && of.mechanisms(island).empty() && of.springs(island).empty() &&
         of.wrenches(island).empty();
}

void Standing::stand(std::size_t island, Moment moment) {
  const bool flies = moment == kAhead;
  for (const std::size_t i : plant_.islands.bodies(island)) {
    plant_.bodies.v[i] = flies ? thrown_up(plant_.model.gravity, h_) : began_.v[i];
    plant_.bodies.w[i] = flies ? Vector3d::Zero() : began_.w[i];
  }
}

void Standing::note(std::span<Contact> contacts, const WarmStart& warm_start,
                    std::span<const IslandFate> fates) {
  if (!notes_) return;
  give_forces(contacts);
  keep_islands(contacts, warm_start, fates);
  std::swap(began_, last_began_);
}

void Standing::give_forces(std::span<Contact> contacts) const {
  if (!any_) return;
  for (std::size_t i = 0; i < match_.size(); ++i) {
    const TouchEnds& touch = plant_.touches[i];
    if (!touch.stands) continue;
    Contact& contact = contacts[touch.contact];
    const Contact& kept = kept_[match_[i]].contact;
    contact.normal_force_n = kept.normal_force_n;
    contact.force_on_a_W = kept.force_on_a_W;
    contact.torque_on_a_W = kept.torque_on_a_W;
  }
}

bool Standing::was_left_as_it_was(std::size_t island, std::span<const Contact> contacts) const {
  // Bodies that other engines or the scene move may move on.
  const auto is_fixed = [&](int number, world::BodyId id) {
    return number >= 0 || plant_.model.bodies[id.index()].fixed;
  };
  const auto stays = [&](std::size_t i) {
    const Touch& touch = plant_.touches[i];
    const Contact& contact = contacts[touch.contact];
    return touch.frozen && touch.record != TouchEnds::kNew && is_fixed(touch.a, contact.body_a) &&
           is_fixed(touch.b, contact.body_b);
  };
  return std::ranges::all_of(plant_.islands.touches(island), stays) &&
         std::ranges::all_of(plant_.islands.bodies(island),
                             [&](std::size_t i) { return is_alike(plant_.bodies, began_, i); });
}

void Standing::keep_islands(std::span<const Contact> contacts, const WarmStart& warm_start,
                            std::span<const IslandFate> fates) {
  stays_.assign(fates.size(), false);
  std::size_t go_on = 0;  // touches that stand, and will be compared again
  bool more = false;
  for (std::size_t island = 0; island < fates.size(); ++island) {
    const bool stood = stands(island);
    if (!stood &&
        (!has_contacts_only(island) || fates[island].fell_short || !was_left_as_it_was(island, contacts)))
      continue;
    stays_[island] = true;
    more = more || !stood;
    go_on += stood ? plant_.islands.touches(island).size() : 0;
  }
  if (!more && go_on == kept_.size()) return;  // mostly the same islands go on
  next_islands_.clear();
  next_island_.assign(plant_.touches.size(), kNone);
  for (std::size_t island = 0; island < fates.size(); ++island) {
    if (!stays_[island]) continue;
    const std::span<const std::size_t> touches = plant_.islands.touches(island);
    for (const std::size_t i : touches) next_island_[i] = next_islands_.size();
    next_islands_.push_back(stands(island) ? kept_islands_[repeats_[island]]
                                           : KeptIsland{touches.size(), fates[island].work});
  }
  next_.clear();
  for (std::size_t i = 0; i < next_island_.size(); ++i) {
    if (next_island_[i] == kNone) continue;
    const TouchEnds& touch = plant_.touches[i];
    KeptTouch& kept = next_.emplace_back(KeptTouch{contacts[touch.contact], {}, next_island_[i]});
    std::ranges::copy(warm_start.record(touch), kept.record.begin());
  }
  std::swap(kept_, next_);
  std::swap(kept_islands_, next_islands_);
}

}  // namespace visum::dynamics::impulse
