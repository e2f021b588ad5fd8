#include "server/collision/collision.h"

#include <algorithm>
#include <cmath>

#include "server/collision/broad_phase.h"
#include "server/collision/narrow_phase.h"
#include "server/collision/shapes.h"

namespace visum::collision {

struct CollisionStage::Impl {
  explicit Impl(const world::WorldModel& world_model)
      : model(world_model), shapes(prepare_shapes(model)), broad(shapes, pairs_that_never_collide(model)) {}

  const world::WorldModel& model;
  std::vector<PreparedShape> shapes;
  BroadPhase broad;
  NarrowPhase narrow;
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

void CollisionStage::find(const world::WorldState& state, std::vector<Contact>& contacts) {
  contacts.clear();
  for (PreparedShape& shape : impl_->shapes) place(shape, impl_->model, state);
  for (const auto& [i, j] : impl_->broad.find(impl_->shapes)) {
    const PreparedShape& a = impl_->shapes[i];
    const PreparedShape& b = impl_->shapes[j];
    const std::vector<Point>& points = impl_->narrow.find(a, b);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (contacts.size() == kMaxContacts) return;
      contacts.push_back(make_contact(a, b, points[k], k));
    }
  }
}

}  // namespace visum::collision
