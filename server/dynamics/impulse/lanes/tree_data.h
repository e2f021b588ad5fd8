// What a tree (tree.h) keeps, as plain numbers that the kernels of both builds share. Vectors have a fourth
// number, which is 0. A matrix is its cyclic diagonals: (xx yy zz), (xy yz zx) and, where it is not
// symmetric, (xz yx zy); their fourth number says nothing, and is finite.
#pragma once

#include <cstddef>

namespace visum::dynamics::impulse {

// How the drive of a node's axis takes part. Only of joints with one axis.
struct TreeAxis {
  bool implicit = false;
  double compliance = 0.0;  // k, (rad/s)/(N·m·s)
};

// One free direction of a node's joint, or a joint without any, or a free root. A joint with several has as
// many rows, one after the other: between them is nothing, and the body is the last one's.
struct TreeRow {
  // What becomes of what a row has for its parent. The rows are taken from the last to the first.
  enum Way : int {
    kNowhere,
    kOn,   // to the row before it, which comes next
    kSet,  // to a sum in memory, as the first of several, or
    kAdd   // as a further one
  };
  double mass = 0.0;
  int node = -1, parent = -1;  // parent: a row
  int body = -1;               // -1: nothing
  int axis = -1;               // of the joint's free directions; -1: none
  Way way = kNowhere;
  bool collects = false;  // there is such a sum for it
  bool root = false;
  bool sums = false;   // one of the two: what is pushed on it is in memory
  bool tip = false;    // the row after it hands nothing on to it
  bool alone = false;  // its joint has one axis
};

struct alignas(32) TreeFactor {
  double r[4] = {}, c[4] = {};
  double Sw[4] = {}, Sv[4] = {};
  double Tw[4] = {}, Tv[4] = {};  // U at the parent's point: Uw + r x Uv, Uv
  // What the parent feels, at its point: the axis' freedom taken out. Of a root, all.
  double A[2][4] = {}, B[3][4] = {}, C[2][4] = {};
  double inverse_D = 0.0;  // effective, of what is left free
  double D = 0.0;          // without its drive
  double gain = 0.0;       // share of a drive's target that the axis takes up
  bool implicit = false;
};

struct alignas(32) TreeAsked {
  double beta[4] = {}, alpha[4] = {};
  double angular[4] = {}, linear[4] = {};
  double target = 0.0, axis_impulse = 0.0;
  bool pushed = false;  // else angular and linear are 0
};

struct alignas(32) TreeAnswer {
  double w[4] = {}, v[4] = {};  // at P. Of a root known before the others'
  double dv[4] = {};            // of the centre of mass
  double alpha[4] = {};         // what was asked, at the parent's point: alpha + r x beta
  double rate = 0.0;            // q'; on the way up t, the part of it that the parent does not decide
  double axis_load = 0.0;       // S^T p + U^T (w1, v1)
};

// What is pushed on a row by those that hang on it, or on a root by all (p).
struct alignas(32) TreeLoad {
  double w[4] = {}, v[4] = {};
};

struct TreeData {
  const TreeRow* rows;
  const TreeFactor* factors;
  const TreeAsked* asked;
  TreeAnswer* answers;
  TreeLoad* loads;
};

// Where the bodies and the joints are: by number of the body, or by node, each a stride further.
struct TreePlace {
  const double *x, *inertia;              // of bodies: 3 numbers, 9 numbers
  const double* points;                   // P
  const double *free_w, *free_v;          // the first of a joint's free directions; the others follow at once
  std::size_t point_stride, free_stride;  // numbers
  const TreeAxis* axes;
};

}  // namespace visum::dynamics::impulse
