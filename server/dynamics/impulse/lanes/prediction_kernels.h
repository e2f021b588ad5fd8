// The sums of a prediction (prediction.h) over all joints. A joint's impulse is six doubles (w, v). A step
// that is done is kept as twelve floats: P and what the line has missed, (w, v) each.
#pragma once

#include "server/dynamics/impulse/lanes/lanes.h"

namespace visum::dynamics::impulse {
namespace {

// Weighs, for each joint, the last step and the one before it. Writes the line, and the line plus what it is
// expected to miss.
void foresee_joints(std::size_t count, const double* given_weights, const double* missed_weights,
                    const float* last, const float* before, double* line, double* foreseen) {
  const double g1 = given_weights[0], g2 = given_weights[1];
  const double m1 = missed_weights[0], m2 = missed_weights[1];
  const Lanes head1 = all(g1), head2 = all(g2), tail1 = all(m1), tail2 = all(m2);
  const Lanes middle1 = lanes(g1, g1, m1, m1), middle2 = lanes(g2, g2, m2, m2);
  for (std::size_t i = 0; i < count; ++i) {
    const Lanes head = head1 * load_floats(last) + head2 * load_floats(before);
    const Lanes middle = middle1 * load_floats(last + 4) + middle2 * load_floats(before + 4);
    const Lanes tail = tail1 * load_floats(last + 8) + tail2 * load_floats(before + 8);
    store(line, head);
    store_pair(line + 4, low(middle));
    store(foreseen, head + join(high(middle), low(tail)));
    store_pair(foreseen + 4, low(middle) + high(tail));
    last += 12;
    before += 12;
    line += 6;
    foreseen += 6;
  }
}

// Writes for each joint what is kept of a step: P, the sum of what it gave at the start (ahead) and at the
// end (after), and what the line has missed at the start; 0 without a line (null).
void keep_joints(std::size_t count, const double* ahead, const double* after, const double* line,
                 float* past) {
  for (std::size_t i = 0; i < count; ++i) {
    const Lanes start = load(ahead);
    const Pair end = load_pair(ahead + 4);
    Pair missed_head{0.0, 0.0};
    Lanes missed_tail = all(0.0);
    if (line != nullptr) {
      missed_head = low(start) - load_pair(line);
      missed_tail = join(high(start), end) - load(line + 2);
      line += 6;
    }
    store_floats(past, start + load(after));
    store_floats(past + 4, join(end + load_pair(after + 4), missed_head));
    store_floats(past + 8, missed_tail);
    ahead += 6;
    after += 6;
    past += 12;
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
