#include "server/dynamics/impulse/islands.h"

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

void join_bodies(world::DisjointSets& sets, int a, int b) {
  if (a >= 0 && b >= 0) sets.join(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
}

int body_of_mechanism(const Plant& plant, std::size_t i) {
  return plant.mechanisms[i].body(0);
}
int body_of_spring(const Plant& plant, std::size_t i) {
  return plant.springs[i].spec.b;
}
int body_of_touch(const Plant& plant, std::size_t i) {
  const Touch& touch = plant.touches[i];
  return touch.asleep ? -1 : std::max(touch.a, touch.b);
}

}  // namespace

Islands::Islands(const Plant& plant)
    : joined_(plant.bodies.size()), sets_(plant.bodies.size()), number_(plant.bodies.size()) {
  for (const Mechanism& mechanism : plant.mechanisms)
    for (std::size_t i = 1; i < mechanism.size(); ++i)
      join_bodies(joined_, mechanism.body(0), mechanism.body(i));
  for (const Spring& spring : plant.springs) join_bodies(joined_, spring.spec.a, spring.spec.b);
  sets_ = joined_;
  list(plant, {});
}

void Islands::find(const Plant& plant, std::span<const Wrench> wrenches) {
  pairs_.clear();
  for (const TouchEnds& touch : plant.touches)
    pairs_.push_back(touch.asleep ? std::array{-1, -1} : std::array{touch.a, touch.b});
  std::swap(pairs_, last_pairs_);
  // With the same pairs as in the last tick the islands are the same, too.
  if (pairs_ == last_pairs_ && wrenches.empty() && wrenches_.things.empty()) return;
  sets_ = joined_;
  for (const auto& [a, b] : last_pairs_) join_bodies(sets_, a, b);
  list(plant, wrenches);
}

void Islands::list(const Plant& plant, std::span<const Wrench> wrenches) {
  std::fill(number_.begin(), number_.end(), kNone);
  const auto mark = [&](int body) {
    if (body >= 0) number_[sets_.leader(static_cast<std::size_t>(body))] = 0;
  };
  for (std::size_t i = 0; i < plant.mechanisms.size(); ++i) mark(body_of_mechanism(plant, i));
  for (std::size_t i = 0; i < plant.springs.size(); ++i) mark(body_of_spring(plant, i));
  for (std::size_t i = 0; i < plant.touches.size(); ++i) mark(body_of_touch(plant, i));
  for (const Wrench& wrench : wrenches) mark(plant.bodies.number(wrench.body));
  count_ = 0;
  for (std::size_t& number : number_)
    if (number != kNone) number = count_++;
  list(bodies_, plant.bodies.size(), [](std::size_t i) { return static_cast<int>(i); });
  list(mechanisms_, plant.mechanisms.size(), [&](std::size_t i) { return body_of_mechanism(plant, i); });
  list(springs_, plant.springs.size(), [&](std::size_t i) { return body_of_spring(plant, i); });
  list(touches_, plant.touches.size(), [&](std::size_t i) { return body_of_touch(plant, i); });
  list(wrenches_, wrenches.size(), [&](std::size_t i) { return plant.bodies.number(wrenches[i].body); });
}

// Counting sort: how many things each island has, where they end, then each thing in its place from behind.
template <typename BodyOf>
void Islands::list(Members& members, std::size_t count, BodyOf body_of) {
  const auto island_of = [&](std::size_t i) {
    const int body = body_of(i);
    return body < 0 ? kNone : number_[sets_.leader(static_cast<std::size_t>(body))];
  };
  members.first.assign(count_ + 1, 0);
  for (std::size_t i = 0; i < count; ++i)
    if (const std::size_t island = island_of(i); island != kNone) ++members.first[island];
  std::partial_sum(members.first.begin(), members.first.end(), members.first.begin());
  members.things.resize(members.first.back());
  for (std::size_t i = count; i-- > 0;)
    if (const std::size_t island = island_of(i); island != kNone) members.things[--members.first[island]] = i;
}

}  // namespace visum::dynamics::impulse
