#include "server/scene/mjcf/contacts.h"

#include <algorithm>
#include <set>

#include "server/scene/model_errors.h"

namespace visum::scene::mjcf {
namespace {

using Pair = std::pair<std::size_t, std::size_t>;

constexpr std::uint64_t kMaxGeomPairs = 50'000'000;

std::set<std::pair<std::string, std::string>> named_pairs(const Element& root) {
  std::set<std::pair<std::string, std::string>> pairs;
  each_child(root, "contact", [&](const Element& contact) {
    each_child(contact, "pair", [&](const Element& pair) {
      const std::string *a = pair.attribute("geom1"), *b = pair.attribute("geom2");
      if (a && b) pairs.insert(std::minmax(*a, *b));
    });
  });
  return pairs;
}

class Separation {
 public:
  Separation(Reading& reading, const std::vector<BodyEntry>& bodies)
      : reading_(reading), bodies_(bodies), pairs_(named_pairs(reading.root)) {}

  void separate() {
    each_child(reading_.root, "contact", [&](const Element& contact) {
      each_child(contact, "exclude",
                 [&](const Element& entry) { keep_error(reading_.errors, [&] { exclude(entry); }); });
    });
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (has_solid(bodies_[i])) groups_[bodies_[i].group].push_back(i);
    for (auto a = groups_.begin(); a != groups_.end(); ++a)
      for (auto b = std::next(a); b != groups_.end(); ++b) separate(*a, *b);
  }

 private:
  using Group = std::pair<const std::size_t, std::vector<std::size_t>>;

  static bool has_solid(const BodyEntry& body) {
    return std::any_of(body.geoms.begin(), body.geoms.end(),
                       [](const Geom& geom) { return !geom.shapes.empty() && geom.shapes.front().collides; });
  }

  void exclude(const Element& entry) {
    const std::string *a = entry.attribute("body1"), *b = entry.attribute("body2");
    if (a == nullptr || b == nullptr) entry.fail("<exclude> needs 'body1' and 'body2'");
    excluded_.insert(std::minmax(find_body(bodies_, *a, entry), find_body(bodies_, *b, entry)));
  }

  void separate(const Group& a, const Group& b) {
    if (!bodies_[a.first].moves && !bodies_[b.first].moves) return;
    const bool neighbours = are_neighbours(a.first, b.first);
    std::size_t touch = 0, apart = 0;
    for (const std::size_t i : a.second)
      for (const std::size_t k : b.second) count(i, k, neighbours, touch, apart);
    if (touch == 0)
      reading_.model.no_collision.emplace_back(link(a.first), link(b.first));
    else if (apart > 0)
      reading_.losses.add("bodies collide with all their geoms or with none, but only some of them are to",
                          *bodies_[b.first].element);
  }

  std::string link(std::size_t body) const { return body == 0 ? kWorldGeoms : bodies_[body].name; }

  // MuJoCo keeps a body and what hangs on it apart, but not what hangs on something that stands still.
  bool are_neighbours(std::size_t a, std::size_t b) const {
    const auto hangs_on = [&](std::size_t lower, std::size_t upper) {
      return bodies_[upper].moves && lower != 0 && bodies_[bodies_[lower].parent].group == upper;
    };
    return hangs_on(a, b) || hangs_on(b, a);
  }

  void count(std::size_t i, std::size_t k, bool neighbours, std::size_t& touch, std::size_t& apart) {
    const bool excluded =
        neighbours || reading_.settings.only_pairs_collide || excluded_.count(std::minmax(i, k));
    for (const Geom& one : bodies_[i].geoms) {
      if (one.shapes.empty() || !one.shapes.front().collides) continue;
      for (const Geom& other : bodies_[k].geoms) {
        if (other.shapes.empty() || !other.shapes.front().collides) continue;
        // Beyond this, what is left counts as touching.
        if (++pairs_seen_ > kMaxGeomPairs) ++touch;
        const bool by_bits = !excluded && ((one.types & other.meets) | (other.types & one.meets)) != 0;
        const bool meet = by_bits || (!pairs_.empty() && is_named(one, other));
        ++(meet ? touch : apart);
      }
      if (pairs_seen_ > kMaxGeomPairs) return;
    }
  }

  bool is_named(const Geom& one, const Geom& other) const {
    return pairs_.count(std::minmax(one.element->name(), other.element->name())) != 0;
  }

  Reading& reading_;
  const std::vector<BodyEntry>& bodies_;
  const std::set<std::pair<std::string, std::string>> pairs_;
  std::set<Pair> excluded_;
  std::map<std::size_t, std::vector<std::size_t>> groups_;
  std::uint64_t pairs_seen_ = 0;
};

}  // namespace

void let_pairs_collide(Reading& reading, std::vector<BodyEntry>& bodies) {
  std::set<std::string> named;
  for (const auto& [a, b] : named_pairs(reading.root)) named.insert({a, b});
  if (named.empty()) return;
  for (BodyEntry& body : bodies)
    for (Geom& geom : body.geoms)
      if (!geom.shapes.empty() && named.count(geom.element->name()) != 0 &&
          geom.shapes.front().kind != world::ShapeKind::kMesh)
        geom.shapes.front().collides = true;
}

void separate_links(Reading& reading, const std::vector<BodyEntry>& bodies) {
  Separation(reading, bodies).separate();
}

}  // namespace visum::scene::mjcf
