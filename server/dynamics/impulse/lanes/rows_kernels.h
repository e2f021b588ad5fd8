// Rows on free bodies (rows.h). A row J is six doubles, its direction on a body: angular, linear. MJ is the
// velocity that a unit impulse along J gives the body. K gets the row's response J MJ to itself added; for
// three rows, K's fourth number gets the last two rows' response to each other.
#pragma once

#include "server/dynamics/impulse/lanes/lanes.h"
#include "server/dynamics/impulse/lanes/six.h"

namespace visum::dynamics::impulse {
namespace {

struct LanesRow {
  Lanes angular, linear;
};

VISUM_LANES_INLINE LanesRow respond(LanesRow J, const double* inverse_inertia, double inverse_mass) {
  return {matrix_times(inverse_inertia, J.angular), inverse_mass * J.linear};
}
VISUM_LANES_INLINE double dot(LanesRow a, LanesRow b) {
  return first(sum3(a.angular * b.angular + a.linear * b.linear));
}

void respond_to_rows(const double* J, std::size_t rows, const double* inverse_inertia, double inverse_mass,
                     double* MJ, double* K) {
  LanesRow response{};
  for (std::size_t i = 0; i < rows; ++i) {
    const LanesRow row{load(J + 6 * i), load3(J + 6 * i + 3)};
    response = respond(row, inverse_inertia, inverse_mass);
    store6(MJ + 6 * i, response.angular, response.linear);
    K[i] += dot(row, response);
  }
  if (rows == 3) K[3] += dot({load(J + 6), load3(J + 9)}, response);
}

// Three rows along the columns of a frame, or against them (sign), at a lever from the centre of mass. J is
// computed here as well, because reading it right after it was written would be slow.
void respond_at_point(const double* frame, const double* lever, double sign, const double* inverse_inertia,
                      double inverse_mass, double* J, double* MJ, double* K) {
  const Lanes r = load3(lever), signs = all(sign);
  LanesRow row[3], response[3];
  for (int i = 0; i < 3; ++i) {
    row[i].linear = signs * load3(frame + 3 * i);
    row[i].angular = cross(r, row[i].linear);
    response[i] = respond(row[i], inverse_inertia, inverse_mass);
    store6(J + 6 * i, row[i].angular, row[i].linear);
    store6(MJ + 6 * i, response[i].angular, response[i].linear);
    K[i] += dot(row[i], response[i]);
  }
  K[3] += dot(row[1], response[2]);
}

// velocity += sum of by_i MJ_i, for three rows. Rows with an impulse of zero change nothing.
void push_body(const double* MJ, const double* by, double* velocity) {
  Six now = load_six(velocity);
  for (int i = 0; i < 3; ++i)
    if (by[i] != 0.0) now = now + by[i] * load_six(MJ + 6 * i);
  store_six(velocity, now);
}

// sums_rs += J_r MJ_s for three rows each, of two ends on one body.
void add_responses_of_rows(const double* J, const double* MJ, double* sums) {
  Lanes columns[6];
  for (int k = 0; k < 6; ++k) columns[k] = lanes(MJ[k], MJ[6 + k], MJ[12 + k], 0.0);
  for (int r = 0; r < 3; ++r) {
    const double* const row = J + 6 * r;
    Lanes sum = all(row[0]) * columns[0];
    for (int k = 1; k < 6; ++k) sum = sum + all(row[k]) * columns[k];
    store3(sums + 3 * r, load3(sums + 3 * r) + sum);
  }
}

// velocity += sum of by_i response_i. Each response has `size` entries, and one follows the other. Rows with
// an impulse of zero change nothing.
void push_by_responses(const double* response, std::size_t size, const double* by, std::size_t rows,
                       double* velocity) {
  const double* given[3] = {};
  double impulse[3] = {};
  std::size_t count = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    if (by[i] == 0.0) continue;
    given[count] = response + i * size;
    impulse[count++] = by[i];
  }
  const auto add = [&](auto sum_of) {
    std::size_t j = 0;
    for (; j + 4 <= size; j += 4)
      store(velocity + j,
            sum_of(load(velocity + j), [&](std::size_t i) { return impulse[i] * load(given[i] + j); }));
    for (; j < size; ++j)
      velocity[j] = sum_of(velocity[j], [&](std::size_t i) { return given[i][j] * impulse[i]; });
  };
  if (count == 1) add([](auto now, auto part) { return now + part(0); });
  if (count == 2) add([](auto now, auto part) { return now + part(0) + part(1); });
  if (count == 3) add([](auto now, auto part) { return now + part(0) + part(1) + part(2); });
}

}  // namespace
}  // namespace visum::dynamics::impulse
