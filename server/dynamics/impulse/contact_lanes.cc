#include "server/dynamics/impulse/contact_lanes.h"

#include <algorithm>

namespace visum::dynamics::impulse {
namespace {

constexpr std::size_t kLanes = 4;

// Copies the members that stay.
void lay_out(ContactBlock& to, std::size_t lane, const RowBlock& block) {
  for (std::size_t e = 0; e < 2; ++e)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 6; ++k)
        to.J[e][i][k][lane] = e < block.end_count ? block.ends[e].J[i][k] : 0.0;
  for (std::size_t e = block.end_count; e < 2; ++e)
    for (std::size_t k = 0; k < 6; ++k) to.velocity[e][k][lane] = 0.0;
  for (std::size_t i = 0; i < 3; ++i) to.K[i][lane] = block.K[i];
  to.compliance[lane] = block.compliance;
  to.least_stiffness[lane] = kRigid * block.free_response;
}

// Copies the members that change from pass to pass.
void lay_out_changes(ContactBlock& to, std::size_t lane, const RowBlock& block, const double* velocities) {
  for (std::size_t e = 0; e < block.end_count; ++e) {
    const double* const velocity = velocities + block.ends[e].offset;
    for (std::size_t k = 0; k < 6; ++k) to.velocity[e][k][lane] = velocity[k];
  }
  for (std::size_t i = 0; i < 3; ++i) to.lambda[i][lane] = block.lambda[i];
}

// Copies the members that change from point to point.
void lay_out_settings(ContactBlock& to, std::size_t lane, const RowBlock& block) {
  for (std::size_t i = 0; i < 3; ++i) {
    to.target[i][lane] = block.target[i];
    to.softness[i][lane] = block.softness[i];
    to.centre[i][lane] = block.centre[i];
    to.base[i][lane] = block.base[i];
    to.inverse_tangential[i][lane] = block.inverse_tangential[i];
  }
  to.low[lane] = block.low;
  to.friction[lane] = block.friction;
  to.sliding_step[lane] = block.sliding_step;
}

}  // namespace

void ContactLanes::lay_out(std::span<const RowBlock> blocks) {
  blocks_.clear();
  others_.clear();
  for (std::size_t i = 0; i < blocks.size(); ++i)
    (blocks[i].kind == RowBlock::Kind::kContact ? blocks_ : others_).push_back(i);
  // The last contact fills the lanes that are left.
  while (blocks_.size() % kLanes != 0) blocks_.push_back(blocks_.back());
  contacts_.resize(std::max(contacts_.size(), blocks_.size() / kLanes));
  for (std::size_t lane = 0; lane < blocks_.size(); ++lane)
    impulse::lay_out(contacts_[lane / kLanes], lane % kLanes, blocks[blocks_[lane]]);
}

void ContactLanes::take_settings(std::span<const RowBlock> blocks) {
  for (std::size_t lane = 0; lane < blocks_.size(); ++lane)
    lay_out_settings(contacts_[lane / kLanes], lane % kLanes, blocks[blocks_[lane]]);
}

void ContactLanes::find_errors(std::span<const RowBlock> blocks, const double* velocities,
                               std::span<std::array<double, 3>> errors) {
  for (std::size_t lane = 0; lane < blocks_.size(); ++lane)
    lay_out_changes(contacts_[lane / kLanes], lane % kLanes, blocks[blocks_[lane]], velocities);
  kernels_->find_errors_of_contacts(contacts_.data(), blocks_.size() / kLanes);
  for (std::size_t lane = 0; lane < blocks_.size(); ++lane)
    for (std::size_t i = 0; i < 3; ++i)
      errors[blocks_[lane]][i] = contacts_[lane / kLanes].errors[i][lane % kLanes];
}

double ContactLanes::largest_miss() const {
  return kernels_->find_misses_of_contacts(contacts_.data(), blocks_.size() / kLanes);
}

}  // namespace visum::dynamics::impulse
