// The data of a tree (tree.h), as plain numbers that the kernels of both builds share. Vectors have a fourth
// number, which is 0. A matrix is kept as its cyclic diagonals: (xx yy zz), (xy yz zx) and, if it is not
// symmetric, (xz yx zy). Their fourth number means nothing, but is finite.
#pragma once

#include <cstddef>

namespace visum::dynamics::impulse {

// How the drive of a node's axis takes part. Only for joints with one axis.
struct TreeAxis {
  bool implicit = false;
  double compliance = 0.0;  // k, (rad/s)/(N·m·s)
};

// One free direction of a node's joint. A joint without any, and a free root, have one row, too. A joint with
// several has as many rows, one behind the other; there is nothing between them, and the body belongs to the
// last one.
struct TreeRow {
  // Where a row's load for its parent goes. The rows are taken from the last to the first.
  enum Way : int {
    kNowhere,  // there is no parent
    kOn,       // to the row before it, which comes next
    kSet,      // to a sum in memory, as its first part
    kAdd       // to that sum, as a further part
  };
  double mass = 0.0;
  int node = -1, parent = -1;  // parent: a row
  int body = -1;               // -1: none
  int axis = -1;               // index of the joint's free direction; -1: none
  int root = -1;               // which free root it is; -1: none
  Way way = kNowhere;
  bool collects = false;  // rows add to a sum in memory for this one
  bool sums = false;      // root or collects: its load is kept in memory
  bool tip = false;       // no row passes its load on to this one in a register
  bool alone = false;     // its joint has one axis
};

// The factors of a row.
struct alignas(32) TreeFactor {
  double r[4] = {}, c[4] = {};  // from the parent's point to P; from P to the centre of mass
  double Sw[4] = {}, Sv[4] = {};
  double Tw[4] = {}, Tv[4] = {};  // U at the parent's point: Uw + r x Uv, Uv
  // The inertia that the parent feels at its own point, with the axis' freedom taken out. For a root the
  // whole inertia.
  double A[2][4] = {}, B[3][4] = {}, C[2][4] = {};
  double inverse_D = 0.0;  // effective: with the drive
  double D = 0.0;          // without the drive
  double gain = 0.0;       // share of the drive's target that the axis takes up
  bool implicit = false;   // the axis has a drive in the tree
};

// The requests to a row.
struct alignas(32) TreeAsked {
  double beta[4] = {}, alpha[4] = {};       // relative velocity
  double angular[4] = {}, linear[4] = {};   // impulse on the body
  double target = 0.0, axis_impulse = 0.0;  // of the axis: rate of the drive, impulse
  bool pushed = false;                      // angular and linear are not 0
};

// The answer of a row.
struct alignas(32) TreeAnswer {
  double w[4] = {}, v[4] = {};  // at P; a root's are found before the others
  double dv[4] = {};            // of the centre of mass
  double alpha[4] = {};         // the request at the parent's point: alpha + r x beta
  double rate = 0.0;       // q'; on the way to the root the part of it that does not depend on the parent
  double axis_load = 0.0;  // S^T p + U^T (w1, v1)
};

// The load p that a row gets from those that hang on it; a root gets it from all.
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

// A unit impulse on a row: on its body, as seen at the centre of mass, or on its axis.
struct alignas(32) TreePush {
  TreePush() {}  // leaves the vectors unset
  double angular[4], linear[4];
  double axis = 0.0;
  int row = -1;  // -1: nothing that moves, and the vectors mean nothing
};

// A row of the matrix of ways (sum_ways), and its factor in a sum.
struct WayTerm {
  std::size_t row = 0;
  double factor = 0.0;
};

// Where bodies and joints are: arrays by number of the body or by node, and the strides of the latter in
// numbers.
struct TreePlace {
  const double *x, *inertia;              // of bodies: 3 numbers, 9 numbers
  const double* points;                   // P of each joint
  const double *free_w, *free_v;          // a joint's first free direction; its others follow directly
  std::size_t point_stride, free_stride;  // in numbers
  const TreeAxis* axes;
};

}  // namespace visum::dynamics::impulse
