// Misses of contacts, four at once (contacts_data.h). The operations and their order are those of one contact
// alone (rows.cc), so that both give the same bits.
#pragma once

#include "server/dynamics/impulse/lanes/contacts_data.h"
#include "server/dynamics/impulse/lanes/lanes.h"

namespace visum::dynamics::impulse {
namespace {

VISUM_LANES_INLINE Lanes velocity_along(const ContactBlock& block, int end, int row) {
  const auto& J = block.J[end][row];
  Lanes sum = load(J[0]) * load(block.velocity[end][0]);
  for (int k = 1; k < 6; ++k) sum = sum + load(J[k]) * load(block.velocity[end][k]);
  return sum;
}

void find_errors_of_contacts(ContactBlock* blocks, std::size_t count) {
  for (ContactBlock* block = blocks; block != blocks + count; ++block)
    for (int row = 0; row < 3; ++row) {
      const Lanes lambda = load(block->lambda[row]);
      const Lanes velocity = (all(0.0) + velocity_along(*block, 0, row)) + velocity_along(*block, 1, row);
      const Lanes soft = load(block->softness[row]) * (lambda - load(block->centre[row]));
      const Lanes error = load(block->target[row]) - velocity - soft;
      store(block->errors[row], row == 0 ? error - load(block->compliance) * lambda : error);
    }
}

// Changes of the tangents' impulses, for what they miss.
struct TangentialLanes {
  Lanes x, y;
};
VISUM_LANES_INLINE TangentialLanes tangents_step(const ContactBlock& block) {
  const Lanes e1 = load(block.errors[1]), e2 = load(block.errors[2]);
  const Lanes start1 = load(block.lambda[1]) + load(block.base[1]),
              start2 = load(block.lambda[2]) + load(block.base[2]);
  const Lanes radius = load(block.friction) * larger(load(block.lambda[0]) + load(block.base[0]), all(0.0));
  const Lanes i11 = load(block.inverse_tangential[0]), i12 = load(block.inverse_tangential[1]),
              i22 = load(block.inverse_tangential[2]);
  const Lanes held1 = start1 + i11 * e1 + i12 * e2, held2 = start2 + i12 * e1 + i22 * e2;
  const Mask holds = held1 * held1 + held2 * held2 <= radius * radius;
  const Lanes step = load(block.sliding_step);
  const Lanes to1 = start1 + step * e1, to2 = start2 + step * e2;
  const Lanes length = root(to1 * to1 + to2 * to2);
  const Lanes scale = radius / length;
  const Mask reaches = length <= radius;
  const Lanes slid1 = choose(reaches, to1, to1 * scale), slid2 = choose(reaches, to2, to2 * scale);
  return {choose(holds, held1, slid1) - start1, choose(holds, held2, slid2) - start2};
}

// The largest velocity that is missing where the bounds allow to give it. Comes after
// find_errors_of_contacts().
double find_misses_of_contacts(const ContactBlock* blocks, std::size_t count) {
  Lanes largest = all(0.0);
  for (const ContactBlock* block = blocks; block != blocks + count; ++block) {
    const Lanes stiffness = load(block->K[0]) + load(block->compliance) + load(block->softness[0]);
    const Lanes now = load(block->lambda[0]), next = now + load(block->errors[0]) / stiffness;
    const Lanes by = larger(next, load(block->low)) - now;
    const TangentialLanes along = tangents_step(*block);
    Lanes miss = larger(magnitude(by) * stiffness, all(0.0));
    miss = larger(magnitude(along.x) * load(block->K[1]), miss);
    miss = larger(magnitude(along.y) * load(block->K[2]), miss);
    miss = choose(load(block->least_stiffness) < stiffness, miss, all(0.0));
    largest = larger(miss, largest);
  }
  double each[4];
  store(each, largest);
  for (int i = 1; i < 4; ++i) each[0] = each[i] > each[0] ? each[i] : each[0];
  return each[0];
}

}  // namespace
}  // namespace visum::dynamics::impulse
