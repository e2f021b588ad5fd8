// What the kernels see of joints (joints/joint.h): plain numbers.
#pragma once

namespace visum::dynamics::impulse {

// Four joints; where there are fewer, the last one again. Points and axes in the bodies' own axes.
struct alignas(32) JointBlock {
  double point_a[3][4] = {}, axis_a[3][4] = {}, point_b[3][4] = {}, axis_b[3][4] = {};
  // Where vectors and matrices of their bodies begin; by node, where their pose, free direction, impulse,
  // request to the tree, and share are.
  long vector_a[4] = {}, vector_b[4] = {}, matrix_a[4] = {}, matrix_b[4] = {};
  long pose[4] = {}, free[4] = {}, impulse[4] = {}, request[4] = {}, node[4] = {};
};

// A joint between two bodies that are pushed.
struct JointEnds {
  long vector_a = 0, vector_b = 0, matrix_a = 0, matrix_b = 0;
  long pose = 0, impulse = 0;
  bool has_a = false;  // else it hangs on what stands still
  double inverse_mass_a = 0.0, inverse_mass_b = 0.0;
};

// What is asked of the tree: relative velocities, angular and linear (tree.h).
struct Asks {
  double *beta, *alpha;
};

}  // namespace visum::dynamics::impulse
