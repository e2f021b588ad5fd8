// Contacts of bodies without joints, laid out four side by side for kernels (lanes/contacts_data.h). The
// results have the bits that Rows finds for each contact alone.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/dynamics/impulse/row_block.h"

namespace visum::dynamics::impulse {

// Owned by Rows, used on one thread. Allocates only while it grows.
class ContactLanes {
 public:
  explicit ContactLanes(const Kernels& by = kernels()) : kernels_(&by) {}

  // Takes the contacts from blocks that are on free bodies alone. Their directions, responses and compliance
  // must then stay.
  void lay_out(std::span<const RowBlock> blocks);
  std::span<const std::size_t> others() const { return others_; }  // the blocks that are not taken
  // Takes what stays while impulses are sought: targets, bounds, softness and its centres. Comes after
  // lay_out(), and again whenever they have changed, before find_errors().
  void take_settings(std::span<const RowBlock> blocks);
  // Puts into `errors`, by block, how much each row of those contacts misses now, m/s.
  void find_errors(std::span<const RowBlock> blocks, const double* velocities,
                   std::span<std::array<double, 3>> errors);
  // The largest miss of those contacts, m/s, where find_errors() has looked last. A NaN counts as 0.
  double largest_miss() const;

 private:
  const Kernels* kernels_;
  std::vector<ContactBlock> contacts_;
  std::vector<std::size_t> blocks_;  // by lane
  std::vector<std::size_t> others_;
};

}  // namespace visum::dynamics::impulse
