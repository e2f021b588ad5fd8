// All kernels in one place. Each build includes it in a file of its own (kernels_baseline.cc,
// kernels_wide.cc).
#pragma once

#include <cstddef>

#include "server/dynamics/impulse/lanes/kernels.h"

#include "server/dynamics/impulse/lanes/blocks_kernels.h"
#include "server/dynamics/impulse/lanes/bodies_kernels.h"
#include "server/dynamics/impulse/lanes/contacts_kernels.h"
#include "server/dynamics/impulse/lanes/joints_kernels.h"
#include "server/dynamics/impulse/lanes/lanes.h"
#include "server/dynamics/impulse/lanes/prediction_kernels.h"
#include "server/dynamics/impulse/lanes/rows_kernels.h"
#include "server/dynamics/impulse/lanes/six.h"
#include "server/dynamics/impulse/lanes/small_kernels.h"
#include "server/dynamics/impulse/lanes/tree_kernels.h"

namespace visum::dynamics::impulse {
namespace {

constexpr Kernels make_kernels(const char* build) {
  return {.build = build,
          .fly = fly,
          .nudge = nudge,
          .commit = commit,
          .largest_turn = largest_turn,
          .orient = orient,
          .place_joints = place_joints,
          .place_hinges = place_hinges,
          .ask_hinges_gaps = ask_hinges_gaps,
          .free_hinges_impulses = free_hinges_impulses,
          .push_joints = push_joints,
          .ask_hinges_velocities = ask_hinges_velocities,
          .foresee_joints = foresee_joints,
          .keep_joints = keep_joints,
          .respond_to_rows = respond_to_rows,
          .respond_at_point = respond_at_point,
          .push_body = push_body,
          .add_responses_of_rows = add_responses_of_rows,
          .push_by_responses = push_by_responses,
          .find_errors_of_contacts = find_errors_of_contacts,
          .find_misses_of_contacts = find_misses_of_contacts,
          .factor_blocks = factor_blocks,
          .add_body_rows = add_body_rows,
          .push_by_body_rows = push_by_body_rows,
          .answer_body_rows = answer_body_rows,
          .factor_envelope = factor_envelope,
          .factor_small = factor_small,
          .solve_small = solve_small,
          .factor_tree = factor_tree,
          .load_tree = load_tree,
          .spread_tree = spread_tree,
          .trace_tree = trace_tree,
          .sum_ways = sum_ways,
          .apply_tree = apply_tree,
          .apply_and_note_tree = apply_and_note_tree,
          .largest_answer_of_tree = largest_answer_of_tree};
}

}  // namespace
}  // namespace visum::dynamics::impulse
