// What the kernels see of the engine's bodies (bodies.h): plain numbers, by body, each matrix by columns.
#pragma once

namespace visum::dynamics::impulse {

struct BodyArrays {
  double *x, *v, *w, *q, *q_WB, *R, *inertia, *inverse_inertia;
  double *x1, *q1, *R1;
};

// Four bodies that move by the same formulas (bodies_kernels.h); where there are fewer, the last one again.
struct alignas(32) BodyBlock {
  double moments[3][4] = {}, inverse_moments[3][4] = {};  // of tops: [0] across, [2] along their axis
  double q_BP[4][4] = {};                                 // x y z w; of those that are not aligned
  // Where their vectors, quaternions and matrices begin.
  long vector[4] = {}, quaternion[4] = {}, matrix[4] = {};
  long answer[4] = {};  // in the tree's answers, in those of a list of bodies
  bool top = false, aligned = true;
  int axis = 2;  // of tops
};

}  // namespace visum::dynamics::impulse
