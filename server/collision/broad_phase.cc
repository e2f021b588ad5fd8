#include "server/collision/broad_phase.h"

#include <algorithm>

#include "server/world/joint_kinds.h"

namespace visum::collision {
namespace {

// The axis on which the boxes' centres spread most.
Eigen::Index widest_axis(const std::vector<PreparedShape>& shapes, const std::vector<std::uint32_t>& boxed) {
  Eigen::AlignedBox3d centers;
  for (const std::uint32_t i : boxed) {
    if (!shapes[i].near_W.isEmpty()) centers.extend(shapes[i].near_W.center());
  }
  Eigen::Index axis = 0;
  if (!centers.isEmpty()) centers.sizes().maxCoeff(&axis);
  return axis;
}

// Height of a box above a plane, m.
double height_above(const PreparedShape& plane, const Eigen::AlignedBox3d& box_W) {
  const Eigen::Vector3d normal = plane.placed.R.col(2);
  const double half = normal.cwiseAbs().dot(0.5 * box_W.sizes());
  return normal.dot(box_W.center() - plane.placed.p) - half;
}

}  // namespace

BroadPhase::BroadPhase(const std::vector<PreparedShape>& shapes, std::vector<BodyPair> never)
    : never_(std::move(never)) {
  for (std::uint32_t i = 0; i < shapes.size(); ++i)
    (shapes[i].kind == world::ShapeKind::kPlane ? planes_ : boxed_).push_back(i);
}

const std::vector<IndexPair>& BroadPhase::find(const std::vector<PreparedShape>& shapes) {
  pairs_.clear();
  sweep(shapes);
  meet_planes(shapes);
  std::sort(pairs_.begin(), pairs_.end());
  return pairs_;
}

bool BroadPhase::may_collide(const PreparedShape& a, const PreparedShape& b) const {
  if (a.body == b.body || (a.unmoved && b.unmoved)) return false;
  const BodyPair pair = std::minmax(a.body, b.body);
  return !std::binary_search(never_.begin(), never_.end(), pair);
}

void BroadPhase::sweep(const std::vector<PreparedShape>& shapes) {
  const Eigen::Index axis = widest_axis(shapes, boxed_);
  // boxed_ stays nearly sorted from tick to tick. The pairs that are found do not depend on its order.
  std::sort(boxed_.begin(), boxed_.end(), [&](std::uint32_t i, std::uint32_t j) {
    const double low_i = shapes[i].near_W.min()[axis], low_j = shapes[j].near_W.min()[axis];
    return low_i < low_j || (low_i == low_j && i < j);
  });
  for (std::size_t i = 0; i < boxed_.size(); ++i) {
    const PreparedShape& a = shapes[boxed_[i]];
    for (std::size_t j = i + 1; j < boxed_.size(); ++j) {
      const PreparedShape& b = shapes[boxed_[j]];
      // All further boxes begin behind a's end.
      if (b.near_W.min()[axis] > a.near_W.max()[axis]) break;
      if (a.near_W.intersects(b.near_W) && may_collide(a, b))
        pairs_.push_back(std::minmax(boxed_[i], boxed_[j]));
    }
  }
}

void BroadPhase::meet_planes(const std::vector<PreparedShape>& shapes) {
  for (const std::uint32_t p : planes_) {
    if (!shapes[p].placed.R.allFinite() || !shapes[p].placed.p.allFinite()) continue;
    for (const std::uint32_t i : boxed_) {
      if (shapes[i].near_W.isEmpty() || !may_collide(shapes[i], shapes[p])) continue;
      if (height_above(shapes[p], shapes[i].near_W) < 0.0) pairs_.push_back(std::minmax(i, p));
    }
  }
}

double gap_of_boxes(const PreparedShape& a, const PreparedShape& b) {
  if (a.kind == world::ShapeKind::kPlane) return height_above(a, b.box_W);
  if (b.kind == world::ShapeKind::kPlane) return height_above(b, a.box_W);
  // The gap along each axis, on either side; the largest is the best.
  const Eigen::Vector3d after = a.box_W.min() - b.box_W.max(), before = b.box_W.min() - a.box_W.max();
  return after.cwiseMax(before).maxCoeff();
}

std::vector<BodyPair> pairs_that_never_collide(const world::WorldModel& model) {
  std::vector<BodyPair> pairs = model.no_collision;
  for (const world::Joint& joint : model.joints) {
    if (joint.parent.valid() && world::info(joint.kind).holds_anything)
      pairs.push_back(std::minmax(joint.parent, joint.child));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace visum::collision
