// All rows at once, with their bounds, by Newton's method.
//
// An answer is a fixed point of the projection: with e what a row misses and s a step size, every contact has
//   l_n = max(low, l_n + s e_n),  l_t = the point of the friction disc that is nearest to l_t + s e_t
// This is smooth except where a contact opens, closes, sticks or slides, and Newton's method works for it
// (Alart, Curnier, A mixed formulation for frictional contact problems prone to Newton like solution methods,
// Computer Methods in Applied Mechanics and Engineering 92, 1991). Each pass asks the projection where every
// row stands, however many have changed sides since, and solves what is left:
//   open       l_n = low, l_t = 0
//   sticks     e_n = 0, e_t = 0
//   slides     e_n = 0; l_t = R d along the direction d of l_t + s e_t, where R = mu l_n follows the normal;
//              across d the disc is round, so that the contact gives way there: e_p = c dl_p with
//              c = (|l_t + s e_t| - R)/(R s)
// Near the answer the miss falls quadratically. A contact that slides there may seem to stick in the first
// pass, if it is asked to slide less than the others' impulses will make it; all rows together would then
// push against each other without limit. So contacts whose friction is at its bound slide on in the first
// pass where the start is known to be near. Far from an answer the passes may cycle: then the best point is
// taken up again, and the caller goes on in another way.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/dynamics/impulse/friction_cone.h"
#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kExact = 1e-3;  // share of the allowed miss below which no further step is worth it
constexpr int kFirstPasses = 5;  // where all of them are hopeless, the others seldom come near
// Share of the friction radius: where the projection leads nearer to the disc's middle, it says nothing of
// the direction in which a contact slides on.
constexpr double kStillAlong = 0.5;

}  // namespace

void Rows::project(RowBlock& block, const std::array<double, 3>& by) {
  if (by == std::array<double, 3>{}) return;
  change(block, by);
  projected_ = true;
}

void Rows::project_normal(RowBlock& block, double to) {
  if (to == block.lambda[0]) return;
  move_normal(block, to);
  projected_ = true;
}

void Rows::slide_along(RowBlock& block, const Tangential& d) {
  const double radius = block.friction * pressure(block);
  project(block, {0.0, radius * d[0] - block.base[1] - block.lambda[1],
                  radius * d[1] - block.base[2] - block.lambda[2]});
}

void Rows::project_contact(std::size_t index, bool keep_sliding) {
  RowBlock& block = blocks_[index];
  block.drags = false;
  if (is_rigid(block)) return;
  // Where the projection leads. The normal decides first; its impulse there is the radius' measure.
  const std::array<double, 3>& missing = errors_[index];
  const double ahead = next_normal(block, missing[0]);
  const bool open = !(ahead > block.low);
  const double radius = block.friction * std::max(0.0, ahead + block.base[0]);
  const double step = block.sliding_step;
  const Tangential to{block.lambda[1] + block.base[1] + step * missing[1],
                      block.lambda[2] + block.base[2] + step * missing[2]};
  if (open) project_normal(block, block.low);
  if (!open) active_.push_back({index, 0});
  const double length = std::sqrt(to[0] * to[0] + to[1] * to[1]);
  const bool goes_on = keep_sliding && !open && is_on_cone(block) && length > kStillAlong * radius;
  if (is_within_disc(to, radius) && !goes_on) {
    if (radius == 0.0) return slide_along(block, {0.0, 0.0});
    active_.push_back({index, 1});
    active_.push_back({index, 2});
    return;
  }
  const Tangential d{to[0] / length, to[1] / length};
  slide_along(block, d);
  if (radius == 0.0) return;
  if (!open) active_.back().drag = {block.friction * d[0], block.friction * d[1]};
  active_.push_back({index, kAcross, {}, {-d[1], d[0]}, std::max(0.0, length - radius) / (radius * step)});
}

void Rows::project_bounded(std::size_t index) {
  RowBlock& block = blocks_[index];
  const double ahead = next_normal(block, errors_[index][0]);
  if (is_rigid(block) || ahead <= block.low || ahead >= block.high)
    project_normal(block, ahead);
  else
    active_.push_back({index, 0});
}

// All rows are projected from one point, though the first ones move it: that their neighbours would see them
// moved does harm where many change sides.
bool Rows::newton_step(bool keep_sliding, bool keep_factor) {
  active_.clear();
  projected_ = false;
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    blocks_[i].kind == RowBlock::Kind::kContact ? project_contact(i, keep_sliding) : project_bounded(i);
  if (active_.empty()) return true;
  if (!(keep_factor && has_factor_of_same_rows()) && !factor_active()) return false;
  find_missing(!projected_);
  solve_factored();
  steps_.assign(blocks_.size(), {});
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const Row& row = active_[i];
    std::array<double, 3>& step = steps_[row.block];
    if (row.row != kAcross) step[row.row] += missing_[i];
    for (std::size_t k = 0; k < 2; ++k) step[k + 1] += (row.drag[k] + row.across[k]) * missing_[i];
  }
  for (std::size_t k = 0; k < blocks_.size(); ++k) change(blocks_[k], steps_[k]);
  return true;
}

void Rows::keep(Point& point) const {
  point.lambda.resize(3 * blocks_.size());
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    std::memcpy(&point.lambda[3 * i], blocks_[i].lambda.data(), sizeof(blocks_[i].lambda));
  point.velocities.assign(velocities_.begin(), velocities_.end());
}

// The velocities contain all impulses of a point, so a step that has led far away leaves nothing behind.
void Rows::put_back(const Point& point) {
  for (std::size_t i = 0; i < blocks_.size(); ++i)
    for (std::size_t j = 0; j < blocks_[i].dim; ++j)
      blocks_[i].applied[j] = blocks_[i].lambda[j] = point.lambda[3 * i + j];
  std::copy(point.velocities.begin(), point.velocities.end(), velocities_.begin());
}

void Rows::lay_out_contacts() {
  if (has_lanes_) return;
  contact_lanes_.lay_out(blocks_);
  has_lanes_ = true;
  has_settings_ = false;
}

// A step that comes no nearer is often the way to an answer, so steps are whole, and the best point counts.
// One step more follows the first that is near enough: it costs little, with the factor of the one before,
// and leaves next to nothing to drift from tick to tick.
double Rows::newton(const Search& by) {
  if (responses_.empty()) lay_out_contacts();
  double best = largest_miss(), nearest = kNever;
  keep(last_);
  try {
    for (int pass = 0; pass < by.most_passes; ++pass) {
      const bool last = best <= by.enough, first = by.near && pass == 0;
      if (last ? !by.exact : best <= by.loose * by.enough) break;
      if (!newton_step(first, first || last)) break;
      const double miss = largest_miss();
      if (miss < best) {
        best = miss;
        keep(last_);
      }
      if (last || best <= kExact * by.enough) break;
      nearest = std::min(nearest, miss);
      if (pass + 1 == kFirstPasses && nearest > by.hopeless) break;
    }
  } catch (const WorkSpent&) {
    put_back(last_);  // a limited step starts from there
    throw;
  }
  put_back(last_);
  return best;
}

}  // namespace visum::dynamics::impulse
