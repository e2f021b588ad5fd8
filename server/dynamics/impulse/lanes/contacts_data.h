// Contacts between bodies without joints, or with the world, four side by side, as kernels see them.
#pragma once

namespace visum::dynamics::impulse {

// Members are those of a block of rows (row_block.h), with a lane for each of four contacts. The normal is
// the first row. Lanes without a second end have zeros there.
struct ContactBlock {
  using Four = double[4];

  Four J[2][3][6];      // by end, row and direction
  Four velocity[2][6];  // of the bodies
  Four target[3], softness[3], lambda[3], centre[3], base[3], K[3];
  Four compliance, low, friction, inverse_tangential[3], sliding_step;
  Four least_stiffness;  // a normal that is no stiffer cannot be moved

  // Found by a kernel: target - velocity - compliance lambda - softness (lambda - centre).
  Four errors[3];
};

}  // namespace visum::dynamics::impulse
