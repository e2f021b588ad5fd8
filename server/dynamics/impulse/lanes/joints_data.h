// Joints as the kernels see them (joints/joint.h): plain numbers.
#pragma once

namespace visum::dynamics::impulse {

// Four joints. Where there are fewer, the last one is repeated. Points and axes are in the bodies' own axes.
struct alignas(32) JointBlock {
  double point_a[3][4] = {}, axis_a[3][4] = {}, point_b[3][4] = {}, axis_b[3][4] = {};
  // Offsets, in numbers: of the bodies' vectors and matrices; by node, of pose, free direction, impulse and
  // request to the tree. `node` is the node itself, the index of its share.
  long vector_a[4] = {}, vector_b[4] = {}, matrix_a[4] = {}, matrix_b[4] = {};
  long pose[4] = {}, free[4] = {}, impulse[4] = {}, request[4] = {}, node[4] = {};
};

// The two bodies of a joint, for impulses on them; offsets as above.
struct JointEnds {
  long vector_a = 0, vector_b = 0, matrix_a = 0, matrix_b = 0;
  long pose = 0, impulse = 0;
  bool has_a = false;  // false: A does not move
  double inverse_mass_a = 0.0, inverse_mass_b = 0.0;
};

// Where requests to the tree are written: relative velocities, angular and linear (tree.h).
struct Asks {
  double *beta, *alpha;
};

}  // namespace visum::dynamics::impulse
