#include "server/collision/fcl_stage.h"

#include <fcl/broadphase/broadphase_SSaP.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/detail/gjk_solver_indep.h>

#include <algorithm>

namespace visum::collision {
namespace {

constexpr double kTolerance = 1e-6;  // as fcl::collide() sets both, by the default of its request

std::shared_ptr<fcl::CollisionGeometryd> make_hull(const Polytope& polytope) {
  auto vertices = std::make_shared<std::vector<Eigen::Vector3d>>(polytope.vertices);
  auto faces = std::make_shared<std::vector<int>>();
  for (const Polytope::Face& face : polytope.faces) {
    faces->push_back(static_cast<int>(face.count));
    for (const std::uint32_t corner : polytope.corners_of(face)) faces->push_back(static_cast<int>(corner));
  }
  return std::make_shared<fcl::Convexd>(vertices, static_cast<int>(polytope.faces.size()), faces);
}

// A mesh takes part by its box, in the broad phase only.
std::shared_ptr<fcl::CollisionGeometryd> make_geometry(const PreparedShape& shape) {
  const Convex* convex = shape.solid ? &shape.solid->convex : nullptr;
  using enum world::ShapeKind;
  switch (shape.kind) {
    case kBox:
      return std::make_shared<fcl::Boxd>(2.0 * convex->polytope.box);
    case kSphere:
      return std::make_shared<fcl::Sphered>(convex->radius);
    case kCapsule:
      return std::make_shared<fcl::Capsuled>(convex->radius, 2.0 * convex->half_length);
    case kCylinder:
      return std::make_shared<fcl::Cylinderd>(convex->radius, 2.0 * convex->half_length);
    case kConvex:
      return make_hull(convex->polytope);
    case kMesh:
      return std::make_shared<fcl::Boxd>(2.0 * shape.box_S.max().cwiseMax(-shape.box_S.min()));
    case kPlane:
      break;
  }
  return nullptr;
}

// Calls act() with the solid as what it is. Planes and meshes are none; touch() is not asked for them.
template <typename Act>
void with_solid(const PreparedShape& shape, const fcl::CollisionGeometryd& solid, const Act& act) {
  using enum world::ShapeKind;
  switch (shape.kind) {
    case kBox:
      return act(static_cast<const fcl::Boxd&>(solid));
    case kSphere:
      return act(static_cast<const fcl::Sphered&>(solid));
    case kCapsule:
      return act(static_cast<const fcl::Capsuled&>(solid));
    case kCylinder:
      return act(static_cast<const fcl::Cylinderd&>(solid));
    case kConvex:
      return act(static_cast<const fcl::Convexd&>(solid));
    case kMesh:
    case kPlane:
      break;
  }
}

// FCL tests boxes with boxes, and spheres with these four kinds, by tests of their own; all others by EPA.
bool is_found_by_epa(world::ShapeKind a, world::ShapeKind b) {
  using enum world::ShapeKind;
  if (a == kBox && b == kBox) return false;
  const auto goes_with_sphere = [](world::ShapeKind kind) {
    return kind == kSphere || kind == kBox || kind == kCapsule || kind == kCylinder;
  };
  return !((a == kSphere && goes_with_sphere(b)) || (b == kSphere && goes_with_sphere(a)));
}

}  // namespace

struct FclStage::Impl {
  // By shape; null for a plane. The object's user data is the shape's index.
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
  fcl::SSaPCollisionManagerd manager;
  fcl::detail::GJKSolver_indepd solver;
  std::vector<fcl::ContactPointd> contacts;  // of one pair
  std::vector<IndexPair> pairs;

  static bool note(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* pairs) {
    const auto number = [](const fcl::CollisionObjectd* object) {
      return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(object->getUserData()));
    };
    static_cast<std::vector<IndexPair>*>(pairs)->push_back(std::minmax(number(a), number(b)));
    return false;  // go on
  }
};

FclStage::FclStage(const std::vector<PreparedShape>& shapes) : impl_(std::make_unique<Impl>()) {
  impl_->solver.gjk_tolerance = impl_->solver.epa_tolerance = kTolerance;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    auto& object = impl_->objects.emplace_back();
    const auto geometry = make_geometry(shapes[i]);
    if (geometry == nullptr) continue;
    object = std::make_unique<fcl::CollisionObjectd>(geometry);
    object->setUserData(reinterpret_cast<void*>(static_cast<std::uintptr_t>(i)));
  }
}

FclStage::~FclStage() = default;

// All are registered anew each time, so that the result does not depend on where the shapes have been.
const std::vector<IndexPair>& FclStage::find_pairs(const std::vector<PreparedShape>& shapes,
                                                   const BroadPhase& broad) {
  std::vector<IndexPair>& pairs = impl_->pairs;
  pairs.clear();
  impl_->manager.clear();
  std::vector<fcl::CollisionObjectd*> present;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (impl_->objects[i] == nullptr || shapes[i].box_W.isEmpty()) continue;
    fcl::CollisionObjectd& object = *impl_->objects[i];
    object.setTransform(shapes[i].placed.R, shapes[i].placed.p);
    object.computeAABB();
    present.push_back(&object);
  }
  impl_->manager.registerObjects(present);
  impl_->manager.setup();
  if (!present.empty()) impl_->manager.collide(&pairs, &Impl::note);
  for (std::uint32_t p = 0; p < shapes.size(); ++p) {
    const PreparedShape& plane = shapes[p];
    if (plane.kind != world::ShapeKind::kPlane || !plane.placed.R.allFinite() || !plane.placed.p.allFinite())
      continue;
    for (std::uint32_t i = 0; i < shapes.size(); ++i)
      if (impl_->objects[i] != nullptr && !shapes[i].box_W.isEmpty() && gap_of_boxes(plane, shapes[i]) < 0.0)
        pairs.push_back(std::minmax(i, p));
  }
  std::erase_if(pairs, [&](const IndexPair& pair) {
    return !broad.may_collide(shapes[pair.first], shapes[pair.second]);
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

FclStage::Touch FclStage::touch(const std::vector<PreparedShape>& shapes, std::size_t a, std::size_t b) {
  const auto frame = [](const Placed& placed) {
    fcl::Transform3d X = fcl::Transform3d::Identity();
    X.linear() = placed.R;
    X.translation() = placed.p;
    return X;
  };
  const Placed &one = shapes[a].placed, &other = shapes[b].placed;
  const auto solid = [&](std::size_t i) -> const fcl::CollisionGeometryd& {
    return *impl_->objects[i]->collisionGeometry();
  };
  impl_->contacts.clear();
  with_solid(shapes[a], solid(a), [&](const auto& solid_a) {
    with_solid(shapes[b], solid(b), [&](const auto& solid_b) {
      impl_->solver.shapeIntersect(solid_a, frame(one), solid_b, frame(other), &impl_->contacts);
    });
  });
  Touch touch;
  for (const fcl::ContactPointd& contact : impl_->contacts) {
    const double depth = std::abs(contact.penetration_depth);
    if (touch.direction && depth <= touch.direction->depth) continue;
    if (!contact.normal.allFinite() || contact.normal.squaredNorm() < 0.5) return {.gave_up = true};
    // FCL's normal leads from its first shape to the second, ours from b to a. Where EPA has found it, FCL
    // 0.7 leaves it in the frame of its first shape, with the other sense. The overlap tells the sense.
    Eigen::Vector3d unit = contact.normal.normalized();
    if (is_found_by_epa(shapes[a].kind, shapes[b].kind)) unit = one.R * unit;
    const bool turned = overlap_along(one, other, unit) > overlap_along(one, other, -unit);
    touch.direction = Direction{false, turned ? (-unit).eval() : unit, depth};
  }
  return touch;
}

}  // namespace visum::collision
