#include "server/collision/collision.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>

#include "server/collision/broad_phase.h"
#include "server/collision/fcl_stage.h"
#include "server/collision/manifold.h"
#include "server/collision/narrow_phase.h"
#include "server/collision/shapes.h"
#include "server/collision/sweep.h"
#include "server/collision/travel.h"

namespace visum::collision {

namespace {

constexpr double kRoundingM = 1e-6;  // more than the error of gaps and paths
bool has_mesh(const PreparedShape& a, const PreparedShape& b) {
  return a.mesh != nullptr || b.mesh != nullptr;
}

// A foreseen contact holds if it ends no deeper than this, or than this share of both half thicknesses: the
// next tick finds it.
constexpr double kHeldM = 2e-4, kHeldShare = 0.25;
constexpr double kLeastGapM = 1e-9;  // of a foreseen contact
constexpr double kTouchingM = 1e-7;  // points that overlap by more have contacts already
constexpr double kTogether = 0.05;   // share of the tick: crossings of one mechanism that count as one
constexpr std::uint64_t kForeseenShare = 8;  // of the work limit, for the points of one crossing

// Shapes that are this far apart (m) are found apart by a fresh look, too.
constexpr double kSurelyApartM = 1e-4;

}  // namespace

struct CollisionStage::Impl {
  Impl(const world::WorldModel& world_model, PreparedMeshes& meshes)
      : model(world_model),
        shapes(prepare_shapes(model, meshes)),
        placed_in(shapes.size(), 0),
        broad(shapes, pairs_that_never_collide(model)),
        travel(shapes, model),
        sweep(shapes, model) {
    if (model.collision_stage == world::CollisionKind::kFcl) fcl.emplace(shapes);
  }

  // The call in which a pair had its points last, where its shapes were placed, and its points in `found`.
  struct Found {
    std::uint64_t call = 0, placed_a = 0, placed_b = 0;
    std::size_t first_point = 0, points = 0;
    double gap = 0.0;
  };
  // A pair of shapes that may touch before the near pairs are searched again, and the path (m, of both bodies
  // together) up to which it cannot touch.
  struct Near {
    std::uint32_t first, second;
    double apart_until = 0.0;
    Found last = {};
  };

  const PreparedShape& placed(std::size_t i, const world::WorldState& state) {
    if (placed_in[i] != call) place(shapes[i], model, state);
    placed_in[i] = call;
    return shapes[i];
  }

  // Searches the near pairs: those whose boxes, widened by how far their bodies may go, meet.
  void find_near(const world::WorldState& state) {
    travel.restart();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const double margin = travel.margin(placed(i, state).body) + kRoundingM;
      shapes[i].near_W = shapes[i].box_W;
      if (shapes[i].box_W.isEmpty()) continue;
      shapes[i].near_W.min().array() -= margin;
      shapes[i].near_W.max().array() += margin;
    }
    near.swap(near_before);
    near.clear();
    // Both lists are sorted. What a pair has found may still hold.
    auto known = near_before.begin();
    for (const auto& [i, j] : broad.find(shapes)) {
      Near& pair = near.emplace_back(Near{i, j});
      while (known != near_before.end() && std::pair(known->first, known->second) < std::pair(i, j)) ++known;
      if (known != near_before.end() && known->first == i && known->second == j) pair.last = known->last;
    }
    near_before.reserve(near.capacity());  // they take turns
  }

  // The whole stage with FCL. Returns false if there are too many contacts.
  bool find_by_fcl(const world::WorldState& state, std::vector<Contact>& contacts);
  // Appends the contacts of a pair. Returns false where they do not fit.
  static bool add(const PreparedShape& a, const PreparedShape& b, std::span<const Point> points,
                  std::vector<Contact>& contacts);
  // Lists the near pairs whose boxes meet.
  void find_meeting(const world::WorldState& state);
  // The contact points of such a pair. If neither shape has moved by a bit since the last call, they are
  // those of the last call; meshes are always tested, since what they may take depends on the others.
  std::span<const Point> points_of(Near& pair);
  // Tests a pair exactly. A mesh in it may take its share of the work.
  const std::vector<Point>& test(const PreparedShape& a, const PreparedShape& b);

  const world::WorldModel& model;
  std::vector<PreparedShape> shapes;
  std::vector<std::uint64_t> placed_in;  // by shape: number of the call that placed it
  std::uint64_t call = 0;
  BroadPhase broad;
  NarrowPhase narrow;
  Travel travel;
  Sweep sweep;
  std::optional<FclStage> fcl;  // only if the scene asks for it
  std::vector<Point> points_of_fcl;
  std::vector<Near> near, near_before;
  // Those of them whose boxes meet now, with the path of their bodies; how many with a mesh are still to
  // test.
  std::vector<std::pair<Near*, double>> meeting;
  std::vector<Point> found, found_before;  // by this call and the last one, of all pairs that were tested
  std::uint64_t meshes_meeting = 0;
  std::uint64_t work = 0;
  std::size_t tested = 0;
  std::vector<world::BodyId> limited;
  // A pair of shapes with contacts that were foreseen since the last find().
  struct Foreseen {
    std::uint32_t first, second;
    double tighter = 0.0;  // m, by which their contacts have been made tighter
    std::array<Eigen::Vector3d, kMaxContactsPerPair> touch_W{};
  };
  std::vector<Foreseen> foreseen;
  world::WorldState at;                               // bodies only, where a pair touches
  std::vector<std::pair<std::size_t, double>> begun;  // by mechanism: share of its first crossing
  // The pair, if contacts were foreseen for it; null: none were.
  Foreseen* known(const Sweep::Crossing& crossing);
  // True if nothing else happens to either mechanism clearly before. Called in the order of the crossings.
  bool is_among_first(const Sweep::Crossing& crossing);
  // For one crossing, as CollisionStage::foresee().
  bool foresee(const Sweep::Crossing& crossing, const world::WorldState& before,
               const world::WorldState& after, std::vector<Contact>* contacts);
};

namespace {

Contact make_contact(const PreparedShape& a, const PreparedShape& b, const Point& point,
                     std::size_t feature) {
  return {a.id,
          b.id,
          a.body,
          b.body,
          static_cast<std::int32_t>(feature),
          point.p_W,
          point.normal_W,
          point.depth,
          std::sqrt(a.friction * b.friction),
          std::max(a.restitution, b.restitution),
          std::max(a.rolling_friction, b.rolling_friction),
          std::max(a.torsional_friction, b.torsional_friction)};
}

}  // namespace

CollisionStage::CollisionStage(const world::WorldModel& model, PreparedMeshes& meshes)
    : impl_(std::make_unique<Impl>(model, meshes)) {}
CollisionStage::CollisionStage(const world::WorldModel& model)
    : CollisionStage(model, *std::make_unique<PreparedMeshes>()) {}
CollisionStage::~CollisionStage() = default;

FastBodies CollisionStage::find_fast(const world::WorldState& before, const world::WorldState& after) {
  return impl_->model.continuous_collision ? impl_->sweep.find_fast(before, after) : FastBodies{};
}

void CollisionStage::hold_back(const world::WorldState& before, world::WorldState& after) {
  if (impl_->model.continuous_collision) impl_->sweep.hold_back(impl_->shapes, impl_->broad, before, after);
}

bool CollisionStage::foresee(const world::WorldState& before, const world::WorldState& after,
                             std::vector<Contact>* contacts) {
  Impl& of = *impl_;
  const std::vector<Sweep::Crossing>& crossings = of.sweep.find_crossings(of.shapes, of.broad, before, after);
  if (crossings.empty()) return false;
  of.at.bodies = before.bodies;
  of.begun.clear();
  bool again = false;
  for (const Sweep::Crossing& crossing : crossings) {
    if (of.known(crossing) == nullptr && !of.is_among_first(crossing)) continue;
    again = of.foresee(crossing, before, after, contacts) || again;
  }
  if (again && contacts != nullptr)
    std::ranges::sort(*contacts, {}, [](const Contact& one) {
      return std::tuple(one.shape_a.value, one.shape_b.value, one.feature);
    });
  return again;
}

CollisionStage::Impl::Foreseen* CollisionStage::Impl::known(const Sweep::Crossing& crossing) {
  const auto found = std::ranges::find_if(foreseen, [&](const Foreseen& pair) {
    return pair.first == crossing.first && pair.second == crossing.second;
  });
  return found == foreseen.end() ? nullptr : &*found;
}

// Crossings come in the order in which they begin.
bool CollisionStage::Impl::is_among_first(const Sweep::Crossing& crossing) {
  bool first = true;
  for (const std::size_t mechanism : {crossing.first_mechanism, crossing.second_mechanism}) {
    if (mechanism == Sweep::kNone) continue;
    const auto known = std::ranges::find(begun, mechanism, &std::pair<std::size_t, double>::first);
    if (known == begun.end())
      begun.emplace_back(mechanism, crossing.share);
    else
      first = first && crossing.share <= known->second + kTogether;
  }
  return first;
}

void CollisionStage::finish_foreseen(std::vector<Contact>& contacts) const {
  if (impl_->foreseen.empty()) return;
  std::erase_if(contacts, [](const Contact& one) { return one.depth < 0.0 && one.normal_force_n == 0.0; });
  for (Contact& one : contacts) {
    if (one.depth >= 0.0) continue;
    one.depth = 0.0;
    one.to_b_W.setZero();
    for (const Impl::Foreseen& pair : impl_->foreseen)
      if (impl_->shapes[pair.first].id == one.shape_a && impl_->shapes[pair.second].id == one.shape_b)
        one.p_W = pair.touch_W[static_cast<std::size_t>(one.feature) - kMaxContactsPerPair];
  }
}

// Where the shapes first touch on their way, the narrow phase tells the points. What they miss along their
// normals when the step begins is the gap. A body that turns moves its points on arcs, which a contact takes
// for lines: what is overlapped in the end tightens the contacts of the next try.
bool CollisionStage::Impl::foresee(const Sweep::Crossing& crossing, const world::WorldState& before,
                                   const world::WorldState& after, std::vector<Contact>* contacts) {
  PreparedShape &a = shapes[crossing.first], &b = shapes[crossing.second];
  for (const world::BodyId body : {a.body, b.body}) sweep.put(body, crossing.share, before, after, at);
  place(a, model, at);
  place(b, model, at);
  const std::vector<Point>& points = narrow.find(a, b, model.collision_work_limit / kForeseenShare);
  const auto carried = [&](const PreparedShape& shape, const Point& point, double to) {
    return sweep.carry(shape, point.p_W, crossing.share, to, before, after);
  };
  const auto depth_at = [&](const Point& point, double share) {
    return point.depth - point.normal_W.dot(carried(a, point, share) - carried(b, point, share));
  };
  // Points that are not apart at first have contacts already.
  double missed = 0.0;
  bool any = false;
  for (const Point& point : points) {
    if (depth_at(point, 0.0) > kTouchingM) continue;
    missed = std::max(missed, depth_at(point, 1.0));
    any = true;
  }
  Foreseen* pair = known(crossing);
  const bool holds = pair != nullptr && missed <= std::max(kHeldM, kHeldShare * crossing.thickness);
  if (!any || holds) return false;
  if (contacts == nullptr) return true;
  if (pair != nullptr)
    pair->tighter += missed;
  else
    pair = &foreseen.emplace_back(Foreseen{crossing.first, crossing.second});
  std::erase_if(*contacts, [&](const Contact& one) {
    return one.depth < 0.0 && one.shape_a == a.id && one.shape_b == b.id;
  });
  for (std::size_t k = 0; k < points.size() && contacts->size() < kMaxContacts; ++k) {
    const Point& point = points[k];
    const double depth = depth_at(point, 0.0);
    if (depth > kTouchingM) continue;
    pair->touch_W[k] = point.p_W;
    Contact& contact = contacts->emplace_back(make_contact(a, b, point, kMaxContactsPerPair + k));
    contact.depth = std::min(depth + pair->tighter, -kLeastGapM);
    contact.p_W = carried(a, point, 0.0);
    contact.to_b_W = carried(b, point, 0.0) - contact.p_W;
  }
  return true;
}

const std::vector<world::BodyId>& CollisionStage::limited() const {
  return impl_->limited;
}

std::uint64_t CollisionStage::work() const {
  return impl_->work;
}

std::size_t CollisionStage::tested() const {
  return impl_->tested;
}

// Closer and closer: by the paths of the bodies, then by the boxes. A pair with a mesh is never left out by
// its path alone, so how many there are depends on the poses only.
void CollisionStage::Impl::find_meeting(const world::WorldState& state) {
  meeting.clear();
  meshes_meeting = 0;
  for (Near& pair : near) {
    const double path = travel.of(shapes[pair.first].body) + travel.of(shapes[pair.second].body);
    if (path < pair.apart_until) continue;
    const PreparedShape& a = placed(pair.first, state);
    const PreparedShape& b = placed(pair.second, state);
    const double gap = gap_of_boxes(a, b);
    pair.apart_until = path + gap - kRoundingM;
    if (gap > 0.0) continue;
    meeting.emplace_back(&pair, path);
    meshes_meeting += has_mesh(a, b);
  }
}

const std::vector<Point>& CollisionStage::Impl::test(const PreparedShape& a, const PreparedShape& b) {
  ++tested;
  if (!has_mesh(a, b)) return narrow.find(a, b);
  const std::uint64_t limit = model.collision_work_limit;
  const std::uint64_t share = (limit - std::min(limit, work)) / meshes_meeting--;
  // A sample may take as much again.
  const std::vector<Point>& points = narrow.find(a, b, std::max<std::uint64_t>(1, share / 2));
  work += narrow.work();
  if (!narrow.is_limited()) return points;
  for (const world::BodyId body : {a.body, b.body})
    if (limited.size() < kMaxNamed && !std::ranges::count(limited, body)) limited.push_back(body);
  return points;
}

std::span<const Point> CollisionStage::Impl::points_of(Near& pair) {
  const PreparedShape &a = shapes[pair.first], &b = shapes[pair.second];
  const std::size_t first = found.size();
  Found& last = pair.last;
  if (last.call + 1 == call && last.placed_a == a.placements && last.placed_b == b.placements &&
      !has_mesh(a, b)) {
    const auto begin = found_before.begin() + static_cast<std::ptrdiff_t>(last.first_point);
    found.insert(found.end(), begin, begin + static_cast<std::ptrdiff_t>(last.points));
  } else {
    const std::vector<Point>& points = test(a, b);
    found.insert(found.end(), points.begin(), points.end());
    last.gap = narrow.gap();
  }
  last = {call, a.placements, b.placements, first, found.size() - first, last.gap};
  return std::span(found).subspan(first);
}

bool CollisionStage::Impl::add(const PreparedShape& a, const PreparedShape& b, std::span<const Point> points,
                               std::vector<Contact>& contacts) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (contacts.size() == kMaxContacts) return false;
    contacts.push_back(make_contact(a, b, points[k], k));
  }
  return true;
}

// Planes and meshes go through our own narrow phase, and so does a pair on which FCL gives up.
bool CollisionStage::Impl::find_by_fcl(const world::WorldState& state, std::vector<Contact>& contacts) {
  for (std::size_t i = 0; i < shapes.size(); ++i) placed(i, state);
  const std::vector<IndexPair>& pairs = fcl->find_pairs(shapes, broad);
  work = tested = 0;
  limited.clear();
  meshes_meeting = 0;
  for (const auto& [i, j] : pairs) meshes_meeting += has_mesh(shapes[i], shapes[j]);
  for (const auto& [i, j] : pairs) {
    const PreparedShape &a = shapes[i], &b = shapes[j];
    const bool convex = a.solid && b.solid;
    const FclStage::Touch touch = convex ? fcl->touch(shapes, i, j) : FclStage::Touch{.gave_up = true};
    if (touch.gave_up) {
      if (!add(a, b, test(a, b), contacts)) return false;
      continue;
    }
    if (!touch.direction) continue;
    points_of_fcl.clear();
    add_manifold(a.placed, b.placed, *touch.direction, points_of_fcl);
    reduce(points_of_fcl, 0, kMaxContactsPerPair);
    if (!add(a, b, points_of_fcl, contacts)) return false;
  }
  return true;
}

bool CollisionStage::find(const world::WorldState& state, std::vector<Contact>& contacts) {
  contacts.clear();
  Impl& of = *impl_;
  of.foreseen.clear();
  ++of.call;
  if (of.fcl) return of.find_by_fcl(state, contacts);
  of.travel.follow(state);
  if (!of.travel.is_within_margins()) of.find_near(state);
  of.find_meeting(state);
  of.work = of.tested = 0;
  of.limited.clear();
  of.found.swap(of.found_before);
  of.found.clear();
  for (const auto& [near, path] : of.meeting) {
    const std::span<const Point> points = of.points_of(*near);
    if (!Impl::add(of.shapes[near->first], of.shapes[near->second], points, contacts)) return false;
    near->apart_until = path + near->last.gap - kSurelyApartM;
  }
  of.found_before.reserve(of.found.capacity());  // they take turns
  return true;
}

}  // namespace visum::collision
