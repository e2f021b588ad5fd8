// The hot loops of the engine over many bodies or joints. They are compiled twice: for every x86-64
// processor, and for those with AVX2. The process chooses one of the two when it starts. Both give the same
// bits, since neither fuses a multiplication with an addition and both keep the same order of operations.
#pragma once

#include <cstddef>

#include "server/dynamics/impulse/lanes/blocks_data.h"
#include "server/dynamics/impulse/lanes/bodies_data.h"
#include "server/dynamics/impulse/lanes/contacts_data.h"
#include "server/dynamics/impulse/lanes/joints_data.h"
#include "server/dynamics/impulse/lanes/small_data.h"
#include "server/dynamics/impulse/lanes/tree_data.h"

namespace visum::dynamics::impulse {

// A table of functions. They are pure: they read and write only the memory that they are given, and do not
// fail.
struct Kernels {
  const char* build;  // for which processor: x86-64 or x86-64-v3

  // Bodies (bodies.h), in blocks of four: free flight over h, first-order change of it, move to it, the
  // fastest angular velocity (rad/s), what that change leaves of hinges' gaps, and everything that follows
  // from the orientations.
  void (*fly)(const BodyArrays&, const BodyBlock*, std::size_t count, double h, const double* gravity);
  void (*nudge)(const BodyArrays&, const BodyBlock*, std::size_t count, double h, const double* dv,
                const double* dw);
  bool (*commit)(const BodyArrays&, const BodyBlock*, std::size_t count, double h, const double* gravity);
  double (*largest_turn)(const BodyArrays&, const BodyBlock*, std::size_t count);
  void (*orient)(const BodyArrays&, const BodyBlock*, std::size_t count);

  // Joints (mechanism.h), in blocks of four. x and R belong to the bodies, now or where the look-ahead leads.
  void (*place_joints)(const double* x, const double* R, const JointBlock*, std::size_t count, double* poses);
  void (*place_hinges)(const double* x, const double* R, const JointBlock*, std::size_t count, double* poses,
                       double* free);
  double (*ask_hinges_gaps)(const double* x, const double* R, const JointBlock*, std::size_t count, double h,
                            double* poses, Asks);
  void (*free_hinges_impulses)(const JointBlock*, std::size_t count, double* poses, double* impulses,
                               double* shares);
  void (*push_joints)(const BodyArrays&, const JointEnds*, std::size_t count, double* poses,
                      double* impulses);
  void (*ask_hinges_velocities)(const BodyArrays&, const JointBlock*, std::size_t count, double* poses, Asks);
  // The prediction (prediction.h), over all joints: what is foreseen, and what is kept of a step.
  void (*foresee_joints)(std::size_t count, const double* given_weights, const double* missed_weights,
                         const float* last, const float* before, double* line, double* foreseen);
  void (*keep_joints)(std::size_t count, const double* ahead, const double* after, const double* line,
                      float* past);
  // Rows of contacts (rows.h): MJ and K of an end, from J or from a frame and a lever.
  void (*respond_to_rows)(const double* J, std::size_t rows, const double* inverse_inertia,
                          double inverse_mass, double* MJ, double* K);
  void (*respond_at_point)(const double* frame, const double* lever, double sign,
                           const double* inverse_inertia, double inverse_mass, double* J, double* MJ,
                           double* K);
  // Gives impulses on three rows to the velocity of the body that has them.
  void (*push_body)(const double* MJ, const double* by, double* velocity);
  // Responses of three rows to three others on one body; and what impulses on rows of a mechanism do to all
  // of its rows.
  void (*add_responses_of_rows)(const double* J, const double* MJ, double* sums);
  void (*push_by_responses)(const double* response, std::size_t size, const double* by, std::size_t rows,
                            double* velocity);
  // Contacts of free bodies, in blocks of four: errors, and then misses, of which the largest is returned.
  void (*find_errors_of_contacts)(ContactBlock*, std::size_t count);
  double (*find_misses_of_contacts)(const ContactBlock*, std::size_t count);
  // Systems of contacts (body_factor.h, envelope_lu.h): factors, false where there are none; and rows, put
  // into a matrix and into its right side, and found from its solution.
  bool (*factor_blocks)(BlockMatrix);
  void (*add_body_rows)(const BodyRow* rows, std::size_t count, double* const* blocks);
  void (*push_by_body_rows)(const BodyRow* rows, std::size_t count, const double* missing, double* to);
  void (*answer_body_rows)(const BodyRow* rows, std::size_t count, const double* v, double* missing);
  bool (*factor_envelope)(EnvelopeMatrix);
  // The same for a few rows (small_system.h); b becomes the solution. `room`: for a row of the responses.
  bool (*factor_small)(SmallMatrix, double* room);
  void (*solve_small)(SmallMatrix, double* b, double* room);
  // Recursions over a tree (tree.h): over all its rows, or over the rows begin..end-1.
  void (*factor_tree)(const TreeRow* rows, TreeFactor* factors, TreePlace place, std::size_t count);
  void (*load_tree)(TreeData tree, std::size_t begin, std::size_t end);
  void (*spread_tree)(TreeData tree, std::size_t begin, std::size_t end);
  std::size_t (*trace_tree)(TreeData tree, std::size_t tree_rows, const TreePush* a, const TreePush* b,
                            std::size_t count, double* ways, std::size_t width, std::size_t* way);
  void (*sum_ways)(const double* ways, std::size_t width, const WayTerm* terms, std::size_t count,
                   std::size_t n, double* to);
  void (*apply_tree)(const TreeRow* rows, const TreeAnswer* answers, std::size_t count, double* v, double* w);
  void (*apply_and_note_tree)(TreeData tree, const double* inertia, std::size_t count, double* v, double* w,
                              double* given);
  double (*largest_answer_of_tree)(const TreeAnswer* answers, std::size_t count);
};

// The kernels that this process uses: the best for its processor, or the build that the environment's
// VISUM_KERNELS names (x86-64 or x86-64-v3). Throws std::runtime_error where it names another one, or one
// that this processor or build does not have.
const Kernels& kernels();

// The two builds; the second is null where the compiler cannot make it.
extern const Kernels kBaselineKernels;
extern const Kernels* const kWideKernels;

}  // namespace visum::dynamics::impulse
