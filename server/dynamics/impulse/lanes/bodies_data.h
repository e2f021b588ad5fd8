// The engine's bodies as the kernels see them (bodies.h): plain numbers by body, matrices by columns.
#pragma once

namespace visum::dynamics::impulse {

// State at t, and (x1, q1, R1) where free flight leads; see Bodies for the meaning and units.
struct BodyArrays {
  double *x, *v, *w, *q, *q_WB, *R, *inertia, *inverse_inertia;
  double *x1, *q1, *R1;
};

// Four bodies that move by the same formulas (bodies_kernels.h). Where there are fewer, the last one is
// repeated.
struct alignas(32) BodyBlock {
  double moments[3][4] = {}, inverse_moments[3][4] = {};  // kg·m²; of tops: [0] across, [2] along their axis
  double q_BP[4][4] = {};                                 // x y z w; only of bodies that are not aligned
  // Where the vectors, quaternions and matrices of the four begin in BodyArrays, in numbers.
  long vector[4] = {}, quaternion[4] = {}, matrix[4] = {};
  long answer[4] = {};  // in the tree's answers, for blocks of a list of bodies
  bool top = false, aligned = true;
  int axis = 2;  // of tops: which of P's axes
};

}  // namespace visum::dynamics::impulse
