#include "server/collision/sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>

#include "server/world/disjoint_sets.h"
#include "server/world/joint_kinds.h"

namespace visum::collision {
namespace {

// A body is left with at least half of this overlap, so that the next tick finds a contact.
constexpr double kOverlapM = 2e-4;
constexpr double kOverlapShare = 0.1;  // and with no more than this share of both thicknesses
// Bodies that close in by less than this share of both thicknesses do not get past each other in a tick.
constexpr double kDeepShare = 0.5;
constexpr int kMostSteps = 64;       // of one search; a free body is then left where the search has come to
constexpr double kBendShare = 0.25;  // by which a way is off its line at most
constexpr double kSameAxis = 1e-9;   // sine of the angle between two axes
constexpr int kMostRounds = 4;       // bodies that are held back by others that are held back

// How deep another body may be in a shape before it comes out behind, m.
double thickness_of(const PreparedShape& shape) {
  return 0.5 * shape.box_S.sizes().minCoeff();
}

// From the centre of mass to the farthest point that turning moves, m. A ball about a point moves only with
// that point.
double turning_reach_of(const PreparedShape& shape, const Eigen::Vector3d& p_BC) {
  const bool is_round = shape.solid && shape.solid->convex.family == Family::kRound;
  const double rounding = is_round ? shape.solid->convex.radius : 0.0;
  const Eigen::AlignedBox3d core(shape.box_S.min().array() + rounding, shape.box_S.max().array() - rounding);
  double reach = 0.0;
  for (int i = 0; i < 8; ++i) {
    const auto corner = static_cast<Eigen::AlignedBox3d::CornerType>(i);
    reach = std::max(reach, (shape.X_BS * core.corner(corner) - p_BC).norm());
  }
  return reach;
}

// The axis through the centre of mass about which a cylinder or capsule is round; 0: there is none.
Eigen::Vector3d round_axis(const PreparedShape& shape, const Eigen::Vector3d& p_BC) {
  constexpr double kSameM = 1e-9;
  const Eigen::Vector3d axis = shape.X_BS.q * Eigen::Vector3d::UnitZ();
  const bool is_round = shape.kind == world::ShapeKind::kCylinder || shape.kind == world::ShapeKind::kCapsule;
  return is_round && (shape.X_BS.p - p_BC).cross(axis).norm() < kSameM ? axis : Eigen::Vector3d::Zero();
}

// The quaternion that means the same rotation as `to` and lies nearer to `from`.
Eigen::Vector4d nearer_to(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  return from.dot(to) < 0.0 ? (-to.coeffs()).eval() : to.coeffs();
}

// The pose of a body's centre of mass on its way: rotations go along the chord of the two quaternions,
// positions straight but for the bend.
world::Pose between(const world::BodyState& from, const world::BodyState& to, const Eigen::Vector3d& bend,
                    double share) {
  const Eigen::Vector4d chord = nearer_to(from.q_WB, to.q_WB) - from.q_WB.coeffs();
  Eigen::Quaterniond q(from.q_WB.coeffs() + share * chord);
  q.normalize();
  return {from.p_WC + share * (to.p_WC - from.p_WC) - share * (1.0 - share) * bend, q};
}

// The rotation vector's direction times the sine of half its angle, of the way from one to the other.
Eigen::Vector3d turning(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  return (Eigen::Quaterniond(nearer_to(from, to)) * from.conjugate()).vec();
}

Eigen::AlignedBox3d widened(Eigen::AlignedBox3d box, double by) {
  box.min().array() -= by;
  box.max().array() += by;
  return box;
}

}  // namespace

// A shape on its body's way.
struct Sweep::Way {
  const PreparedShape& shape;
  const Body& body;
  const world::Body& model;
  const world::BodyState &from, &to;

  void put(double share, Placed& placed) const {
    const world::Pose C = between(from, to, body.bend, share);
    const world::Pose X_WS = link_pose(model, {C.p, C.q, from.v_WC, from.w_WB}) * shape.X_BS;
    placed.R = X_WS.q.toRotationMatrix();
    placed.p = X_WS.p;
  }
  // Unit, about which the body turns on its way; 0: it does not.
  Eigen::Vector3d axis() const { return turning(from.q_WB, to.q_WB).stableNormalized(); }
};

Sweep::Way Sweep::way_of(const PreparedShape& shape, const world::WorldState& before,
                         const world::WorldState& after) const {
  const std::size_t i = shape.body.index();
  return {shape, bodies_[i], model_.bodies[i], before.bodies[i], after.bodies[i]};
}

Sweep::Sweep(const std::vector<PreparedShape>& shapes, const world::WorldModel& model)
    : model_(model), bodies_(model.bodies.size()) {
  for (Body& body : bodies_) body.thickness = std::numeric_limits<double>::infinity();
  std::vector<int> shape_counts(model.bodies.size(), 0);
  for (const PreparedShape& shape : shapes) {
    Body& body = bodies_[shape.body.index()];
    if (shape.box_S.isEmpty()) continue;
    body.thickness = std::min(body.thickness, thickness_of(shape));
    body.turning_reach =
        std::max(body.turning_reach, turning_reach_of(shape, model.bodies[shape.body.index()].p_BC));
    if (shape.fixed) continue;
    // A body is round if all of its shapes are, about one axis.
    const Eigen::Vector3d axis = round_axis(shape, model.bodies[shape.body.index()].p_BC);
    if (shape_counts[shape.body.index()]++ == 0) body.round_B = axis;
    if (axis.isZero(0.0) || axis.cross(body.round_B).norm() > kSameAxis) body.round_B.setZero();
    moving_.push_back(shape.body.index());
  }
  std::sort(moving_.begin(), moving_.end());
  moving_.erase(std::unique(moving_.begin(), moving_.end()), moving_.end());
  for (const std::size_t i : moving_)
    if (!model.bodies[i].kinematic) bodies_[i].kind = Kind::kFree;
  const auto link = [this](world::BodyId body) {
    if (body.valid() && bodies_[body.index()].kind == Kind::kFree) bodies_[body.index()].kind = Kind::kLinked;
  };
  for (const world::Joint& joint : model.joints) {
    if (!world::info(joint.kind).holds_anything) continue;
    link(joint.parent);
    link(joint.child);
  }
  number_mechanisms();
}

void Sweep::number_mechanisms() {
  world::DisjointSets joined(bodies_.size());
  const auto is_linked = [this](std::size_t i) { return bodies_[i].kind == Kind::kLinked; };
  for (const world::Joint& joint : model_.joints)
    if (joint.parent.valid() && is_linked(joint.parent.index()) && is_linked(joint.child.index()))
      joined.join(joint.parent.index(), joint.child.index());
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    if (is_linked(i)) bodies_[i].mechanism = joined.leader(i);
}

// Along the chord of two quaternions a point at r from the centre of mass goes by at most sqrt(2) times 2 r
// the chord: the chord's middle, where the rotation is fastest, is at least 1/sqrt(2) away from 0.
FastBodies Sweep::find_fast(const world::WorldState& before, const world::WorldState& after) {
  const double tick_s = 1e-9 * static_cast<double>(model_.tick_ns);
  double farthest = 0.0;
  // By how much a body moves farther than it may, at most; by kind.
  std::array<double, 3> beyond;
  beyond.fill(-std::numeric_limits<double>::infinity());
  for (const std::size_t i : moving_) {
    Body& body = bodies_[i];
    const world::BodyState &from = before.bodies[i], &to = after.bodies[i];
    body.share = 1.0;
    body.way = to.p_WC - from.p_WC;
    body.turn = 2.0 * std::numbers::sqrt2 * body.turning_reach *
                (nearer_to(from.q_WB, to.q_WB) - from.q_WB.coeffs()).norm();
    if (body.kind == Kind::kLinked) body.bend = tick_s * to.v_WC - body.way;
    if (body.round_B != Eigen::Vector3d::Zero())
      body.turn *= turning(from.q_WB, to.q_WB).stableNormalized().cross(from.q_WB * body.round_B).norm();
    const double moved = body.way.norm() + body.turn + kBendShare * body.bend.norm();
    farthest = std::max(farthest, moved);
    double& of_kind = beyond[static_cast<std::size_t>(body.kind)];
    of_kind = std::max(of_kind, moved - kDeepShare * body.thickness);
  }
  const auto any = [&](Kind kind) { return beyond[static_cast<std::size_t>(kind)] + farthest > 0.0; };
  return {any(Kind::kFree), any(Kind::kLinked)};
}

void Sweep::hold_back(std::vector<PreparedShape>& shapes, BroadPhase& broad, const world::WorldState& before,
                      world::WorldState& after) {
  for (int round = 0; round < kMostRounds && find_fast(before, after).free; ++round) {
    list_pairs(Kind::kFree, shapes, broad, before, after);
    for (const auto& [first, second] : pairs_) {
      Body& held = bodies_[shapes[first].body.index()];
      const auto share =
          first_touch(way_of(shapes[first], before, after), way_of(shapes[second], before, after));
      if (share.value_or(1.0) >= held.share) continue;
      held.share = *share;
      held.other = shapes[second].body;
    }
    bool any = false;
    for (const std::size_t i : moving_) {
      if (bodies_[i].share == 1.0) continue;
      leave_at_touch(i, before, after);
      any = true;
    }
    if (!any) return;
  }
}

const std::vector<Sweep::Crossing>& Sweep::find_crossings(std::vector<PreparedShape>& shapes,
                                                          BroadPhase& broad, const world::WorldState& before,
                                                          const world::WorldState& after) {
  crossings_.clear();
  if (!find_fast(before, after).linked) return crossings_;
  list_pairs(Kind::kLinked, shapes, broad, before, after);
  for (const auto& [i, j] : pairs_) {
    const auto share = first_touch(way_of(shapes[i], before, after), way_of(shapes[j], before, after));
    const auto mechanism_of = [&](std::size_t k) { return bodies_[shapes[k].body.index()].mechanism; };
    if (share)
      crossings_.push_back({i, j, *share, thickness_of(shapes[i]) + thickness_of(shapes[j]), mechanism_of(i),
                            mechanism_of(j)});
  }
  for (Crossing& of : crossings_) {
    if (of.first < of.second) continue;
    std::swap(of.first, of.second);
    std::swap(of.first_mechanism, of.second_mechanism);
  }
  std::ranges::sort(crossings_, {},
                    [](const Crossing& of) { return std::tuple(of.share, of.first, of.second); });
  return crossings_;
}

void Sweep::put(world::BodyId body, double share, const world::WorldState& before,
                const world::WorldState& after, world::WorldState& at) const {
  const std::size_t i = body.index();
  const world::Pose C = between(before.bodies[i], after.bodies[i], bodies_[i].bend, share);
  at.bodies[i] = {C.p, C.q, before.bodies[i].v_WC, before.bodies[i].w_WB};
}

Eigen::Vector3d Sweep::carry(const PreparedShape& shape, const Eigen::Vector3d& p_W, double from, double to,
                             const world::WorldState& before, const world::WorldState& after) const {
  if (shape.fixed) return p_W;
  const Way way = way_of(shape, before, after);
  const world::Pose first = between(way.from, way.to, way.body.bend, from);
  const world::Pose then = between(way.from, way.to, way.body.bend, to);
  // Nothing of a ball moves but its centre.
  const Eigen::Vector3d centre_C = shape.X_BS.p - way.model.p_BC;
  if (shape.kind == world::ShapeKind::kSphere)
    return p_W + (then.p + then.q * centre_C) - (first.p + first.q * centre_C);
  Eigen::Quaterniond turned = then.q * first.q.conjugate();
  // Without its share about the axis (swing and twist).
  if (way.body.round_B != Eigen::Vector3d::Zero()) {
    const Eigen::Vector3d axis = first.q * way.body.round_B, about = turned.vec().dot(axis) * axis;
    turned =
        turned * Eigen::Quaterniond(turned.w(), about.x(), about.y(), about.z()).normalized().conjugate();
  }
  return then.p + turned * (p_W - first.p);
}

// How far a body on its way may be beyond the boxes of its begin and its end, m.
double Sweep::beyond_boxes(const Body& body) {
  return body.turn + kBendShare * body.bend.norm() + kOverlapM;
}

void Sweep::list_pairs(Kind kind, std::vector<PreparedShape>& shapes, BroadPhase& broad,
                       const world::WorldState& before, const world::WorldState& after) {
  for (PreparedShape& shape : shapes) {
    place(shape, model_, after);
    shape.near_W = shape.box_W;
    place(shape, model_, before);
    if (shape.box_W.isEmpty() || shape.near_W.isEmpty())
      shape.near_W.setEmpty();
    else
      shape.near_W = widened(shape.near_W.merged(shape.box_W), beyond_boxes(bodies_[shape.body.index()]));
  }
  pairs_.clear();
  for (const IndexPair& pair : broad.find(shapes)) add_pair(kind, shapes, pair);
}

void Sweep::add_pair(Kind kind, const std::vector<PreparedShape>& shapes, const IndexPair& pair) {
  const PreparedShape &first = shapes[pair.first], &second = shapes[pair.second];
  const Body &a = bodies_[first.body.index()], &b = bodies_[second.body.index()];
  const bool is_plane = first.kind == world::ShapeKind::kPlane || second.kind == world::ShapeKind::kPlane;
  if (is_plane || (first.mesh != nullptr && second.mesh != nullptr)) return;
  if (a.kind != kind && b.kind != kind) return;
  // Where a linked body meets a free one, the free one is held back.
  if (kind == Kind::kLinked && (a.kind == Kind::kFree || b.kind == Kind::kFree)) return;
  // No engine sees a contact of two engines as one of its own (dynamics/coupling.h).
  const auto engine_of = [&](const PreparedShape& shape) { return model_.bodies[shape.body.index()].engine; };
  if (a.kind == Kind::kLinked && b.kind == Kind::kLinked && engine_of(first) != engine_of(second)) return;
  const double thickness = thickness_of(first) + thickness_of(second);
  const double bends = kBendShare * (a.bend.norm() + b.bend.norm());
  if ((a.way - b.way).norm() + a.turn + b.turn + bends <= kDeepShare * thickness) return;
  // The body that moved farther is held back, if both are of the kind.
  const bool holds_first =
      a.kind == kind && (b.kind != kind || a.way.norm() + a.turn >= b.way.norm() + b.turn);
  pairs_.push_back(holds_first ? pair : IndexPair{pair.second, pair.first});
}

std::optional<double> Sweep::first_touch(const Way& held, const Way& other) {
  if (held.shape.mesh != nullptr) return first_touch_with_mesh(held, other);
  if (other.shape.mesh != nullptr) return first_touch_with_mesh(other, held);
  return first_touch_of_convex(held, held.shape.placed, other, other.shape.placed,
                               thickness_of(held.shape) + thickness_of(other.shape));
}

std::optional<double> Sweep::first_touch_with_mesh(const Way& mesh, const Way& convex) {
  const PreparedShape& shape = mesh.shape;
  const double thickness = thickness_of(convex.shape);
  const Eigen::Vector3d way = convex.body.way - mesh.body.way;
  const double turn = convex.body.turn + mesh.body.turn;
  // The box around the convex shape's way as the mesh sees it, in the mesh's frame at the tick's begin.
  const Eigen::Matrix3d R = shape.placed.R.transpose();
  const Eigen::AlignedBox3d box = box_around(
      widened(convex.shape.near_W, mesh.body.way.norm() + beyond_boxes(mesh.body)), R, -(R * shape.placed.p));
  std::optional<double> first;
  shape.mesh->visit(
      [&](const Eigen::AlignedBox3d& node) { return node.intersects(box); },
      [&](std::uint32_t i) {
        const MeshTriangle& triangle = shape.mesh->triangles()[i];
        // A body that slides along a surface crosses none of its triangles.
        if (std::abs((shape.placed.R * triangle.normal).dot(way)) + turn <= kDeepShare * thickness) return;
        const Placed placed = triangle_.place(shape, triangle);
        const auto share = first_touch_of_convex(convex, convex.shape.placed, mesh, placed, thickness);
        if (share && *share < first.value_or(1.0)) first = share;
      });
  return first;
}

// m in the whole tick, at most, by which turning and the bend bring a body nearer along a direction.
double Sweep::closing_by_turn(const Body& body, const Eigen::Vector3d& axis, const Eigen::Vector3d& along) {
  return body.turn * axis.cross(along).norm() + std::abs(body.bend.dot(along));
}

// Each step goes as far as the gap allows along the direction in which the shapes are apart, or overlap
// least. Shapes that touch from the beginning may come a little deeper if the body is free: the other end of
// a plate that has landed on one edge is not to swing through the floor. Linked ones that touch have contacts
// already, and only a touch is worth another try.
std::optional<double> Sweep::first_touch_of_convex(const Way& way_a, Placed a, const Way& way_b, Placed b,
                                                   double thickness) {
  const double least = std::min(kOverlapM, kOverlapShare * thickness);
  const Eigen::Vector3d way = way_a.body.way - way_b.body.way;
  const Eigen::Vector3d axis_a = way_a.axis(), axis_b = way_b.axis();
  const bool is_free = way_a.body.kind == Kind::kFree || way_b.body.kind == Kind::kFree;
  double wanted = least, share = 0.0;
  for (int step = 0; step < kMostSteps; ++step) {
    way_a.put(share, a);
    way_b.put(share, b);
    const auto [apart_W, overlap] = least_overlap(a, b);
    if (step == 0 && overlap > 0.0 && !is_free) return std::nullopt;
    if (step == 0) wanted = std::max(overlap, 0.0) + least;
    if (overlap > kDeepShare * thickness) return std::nullopt;  // too deep to be told what is in front
    // m in the whole tick
    const double closing = closing_by_turn(way_a.body, axis_a, apart_W) +
                           closing_by_turn(way_b.body, axis_b, apart_W) - apart_W.dot(way);
    if (closing <= kDeepShare * thickness || (1.0 - share) * closing <= least) return std::nullopt;
    if (overlap > wanted - 0.5 * least) return share;
    share += (wanted - overlap) / closing;
  }
  return is_free ? std::optional(share) : std::nullopt;
}

// Unit direction from b to a, and the overlap along it; negative: apart.
std::pair<Eigen::Vector3d, double> Sweep::least_overlap(const Placed& a, const Placed& b) {
  if (const auto apart_W = solver_.separating_direction(a, b)) {
    const double overlap = overlap_along(a, b, *apart_W);
    if (overlap <= 0.0) return {*apart_W, overlap};
  }
  const Direction found = find_direction(a, b, solver_);
  if (found.apart) return {(a.center() - b.center()).stableNormalized(), 0.0};
  return {found.normal_W, found.depth};
}

void Sweep::leave_at_touch(std::size_t body, const world::WorldState& before,
                           world::WorldState& after) const {
  const Body& held = bodies_[body];
  const std::size_t other = held.other.index();
  world::Pose touching = between(before.bodies[body], after.bodies[body], held.bend, held.share);
  if (!model_.bodies[other].fixed) {
    const world::Pose then =
        between(before.bodies[other], after.bodies[other], bodies_[other].bend, held.share);
    touching = between(before.bodies[other], after.bodies[other], bodies_[other].bend, 1.0) *
               (then.inverse() * touching);
  }
  after.bodies[body].p_WC = touching.p;
  after.bodies[body].q_WB = touching.q;
}

}  // namespace visum::collision
