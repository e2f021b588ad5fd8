#include "server/collision/collision.h"

#include <algorithm>
#include <cmath>

#include "server/collision/broad_phase.h"
#include "server/collision/narrow_phase.h"
#include "server/collision/shapes.h"
#include "server/collision/travel.h"

namespace visum::collision {

namespace {

constexpr double kRoundingM = 1e-6;  // more than the error of gaps and paths
// Shapes that are this far apart (m) are found apart by a fresh look, too.
constexpr double kSurelyApartM = 1e-4;

}  // namespace

struct CollisionStage::Impl {
  explicit Impl(const world::WorldModel& world_model)
      : model(world_model),
        shapes(prepare_shapes(model, meshes)),
        placed_in(shapes.size(), 0),
        broad(shapes, pairs_that_never_collide(model)),
        travel(shapes, model) {}

  // A pair of shapes that may touch before the near pairs are searched again, and the path (m, of both bodies
  // together) up to which it cannot touch.
  struct Near {
    std::uint32_t first, second;
    double apart_until = 0.0;
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
    near.clear();
    for (const auto& [i, j] : broad.find(shapes)) near.push_back({i, j});
  }

  const world::WorldModel& model;
  PreparedMeshes meshes;
  std::vector<PreparedShape> shapes;     // of them
  std::vector<std::uint64_t> placed_in;  // by shape: number of the call that placed it
  std::uint64_t call = 0;
  BroadPhase broad;
  NarrowPhase narrow;
  Travel travel;
  std::vector<Near> near;
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

CollisionStage::CollisionStage(const world::WorldModel& model) : impl_(std::make_unique<Impl>(model)) {}
CollisionStage::~CollisionStage() = default;

bool CollisionStage::find(const world::WorldState& state, std::vector<Contact>& contacts) {
  contacts.clear();
  Impl& of = *impl_;
  ++of.call;
  of.travel.follow(state);
  if (!of.travel.is_within_margins()) of.find_near(state);
  // Near pairs, closer and closer: by the paths of their bodies, by their boxes, then exactly.
  for (Impl::Near& near : of.near) {
    const double path = of.travel.of(of.shapes[near.first].body) + of.travel.of(of.shapes[near.second].body);
    if (path < near.apart_until) continue;
    const PreparedShape& a = of.placed(near.first, state);
    const PreparedShape& b = of.placed(near.second, state);
    const double gap = gap_of_boxes(a, b);
    near.apart_until = path + gap - kRoundingM;
    if (gap > 0.0) continue;
    const std::vector<Point>& points = of.narrow.find(a, b);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (contacts.size() == kMaxContacts) return false;
      contacts.push_back(make_contact(a, b, points[k], k));
    }
    near.apart_until = path + of.narrow.gap() - kSurelyApartM;
  }
  return true;
}

}  // namespace visum::collision
