// Joints in their bodies' poses, four at once. Symbols: joints/joint.h, tree.h; for hinges joints/hinge.h.
#pragma once

#include "server/dynamics/impulse/lanes/joints_data.h"
#include "server/dynamics/impulse/lanes/vectors.h"

namespace visum::dynamics::impulse {
namespace {

struct Poses {
  Vectors pa, pb, a, b;
};

VISUM_LANES_INLINE Vectors constant(const double (&u)[3][4]) {
  return {load(u[0]), load(u[1]), load(u[2])};
}

VISUM_LANES_INLINE Poses poses(const double* x, const double* R, const JointBlock& block) {
  const Matrices Ra = load_matrices(Four{R, block.matrix_a}), Rb = load_matrices(Four{R, block.matrix_b});
  return {load_vectors(Four{x, block.vector_a}) + Ra * constant(block.point_a),
          load_vectors(Four{x, block.vector_b}) + Rb * constant(block.point_b), Ra * constant(block.axis_a),
          Rb * constant(block.axis_b)};
}

// The four vectors with which a JointPose begins, one behind the other.
VISUM_LANES_INLINE void store_poses(Four<double> at, const Poses& of) {
  store_two(at, of.pa.x, of.pa.y);
  store_two(moved(at, 2), of.pa.z, of.pb.x);
  store_two(moved(at, 4), of.pb.y, of.pb.z);
  store_two(moved(at, 6), of.a.x, of.a.y);
  store_two(moved(at, 8), of.a.z, of.b.x);
  store_two(moved(at, 10), of.b.y, of.b.z);
}

void place_joints(const double* x, const double* R, const JointBlock* blocks, std::size_t count, double* to) {
  for (const JointBlock* block = blocks; block != blocks + count; ++block)
    store_poses(Four{to, block->pose}, poses(x, R, *block));
}

// Also stores the direction in which each hinge is free.
void place_hinges(const double* x, const double* R, const JointBlock* blocks, std::size_t count, double* to,
                  double* free) {
  for (const JointBlock* block = blocks; block != blocks + count; ++block) {
    const Poses of = poses(x, R, *block);
    store_poses(Four{to, block->pose}, of);
    store_vectors(Four{free, block->free}, of.a);
  }
}

// Asks for the motion that closes the hinges' gaps. Returns the largest gap, m or rad; NaN if one is NaN.
double ask_hinges_gaps(const double* x, const double* R, const JointBlock* blocks, std::size_t count,
                       double h, double* to, Asks asks) {
  const double per_h = 1.0 / h;
  Lanes most = all(0.0), sum = all(0.0);
  for (const JointBlock* block = blocks; block != blocks + count; ++block) {
    const Poses of = poses(x, R, *block);
    store_poses(Four{to, block->pose}, of);
    const Vectors turn = cross(of.b, of.a), shift = of.pa - of.pb;
    most = largest(shift, largest(turn, most));
    const Vectors both = turn + shift;
    sum = sum + (both.x + both.y + both.z);
    store_vectors(Four{asks.beta, block->request}, per_h * turn);
    store_vectors(Four{asks.alpha, block->request}, per_h * shift);
  }
  // A NaN in any gap makes the sum NaN, since largest() does not notice it.
  const double nothing = (first(sum) + low(sum)[1]) + (high(sum)[0] + high(sum)[1]);
  return nothing == nothing ? largest_of(most) : nothing;
}

// Asks for what makes the velocities of the hinges' bodies agree. The rate about the axis is no error, the
// rest must go.
void ask_hinges_velocities(const BodyArrays& of, const JointBlock* blocks, std::size_t count, double* poses,
                           Asks asks) {
  for (const JointBlock* block = blocks; block != blocks + count; ++block) {
    const Four<double> at{poses, block->pose};
    const Vectors p = load_vectors(moved(at, 3)), axis = load_vectors(moved(at, 6));
    const Vectors wa = load_vectors(Four{of.w, block->vector_a}),
                  wb = load_vectors(Four{of.w, block->vector_b});
    const Vectors ra = p - load_vectors(Four{of.x, block->vector_a}),
                  rb = p - load_vectors(Four{of.x, block->vector_b});
    const Vectors v = (load_vectors(Four{of.v, block->vector_a}) + cross(wa, ra)) -
                      (load_vectors(Four{of.v, block->vector_b}) + cross(wb, rb));
    const Vectors w = wa - wb;
    store_vectors(Four{asks.beta, block->request}, w - dot(axis, w) * axis);
    store_vectors(Four{asks.alpha, block->request}, v);
  }
}

// Takes from the hinges' impulses their share about the axis, and stores that share.
void free_hinges_impulses(const JointBlock* blocks, std::size_t count, double* poses, double* impulses,
                          double* shares) {
  for (const JointBlock* block = blocks; block != blocks + count; ++block) {
    const Vectors axis = load_vectors(moved(Four{poses, block->pose}, 6));
    const Four<double> at{impulses, block->impulse};
    const Vectors w = load_vectors(at);
    const Lanes share = dot(axis, w);
    store_vectors(at, w - share * axis);
    store_one(Four{shares, block->node}, share);
  }
}

// Gives the impulse (w, v) at the point p to one body.
VISUM_LANES_INLINE void push(const BodyArrays& of, long vector, long matrix, double inverse_mass, Lanes p,
                             Lanes w, Lanes v) {
  double *at_v = of.v + vector, *at_w = of.w + vector;
  const Lanes twist = w + cross(p - load3(of.x + vector), v);
  store3(at_v, load3(at_v) + inverse_mass * v);
  store3(at_w, load3(at_w) + matrix_times(of.inverse_inertia + matrix, twist));
}

// Gives each joint's impulse at its point P to both of its bodies, joint after joint.
void push_joints(const BodyArrays& of, const JointEnds* joints, std::size_t count, double* poses,
                 double* impulses) {
  for (const JointEnds* joint = joints; joint != joints + count; ++joint) {
    const double* impulse = impulses + joint->impulse;
    const Lanes w = load3(impulse), v = load3(impulse + 3);
    const Lanes p = load3(poses + joint->pose + 3);
    push(of, joint->vector_b, joint->matrix_b, joint->inverse_mass_b, p, w, v);
    if (joint->has_a) push(of, joint->vector_a, joint->matrix_a, joint->inverse_mass_a, p, -w, -v);
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
