// The recursions over a tree's rows. Symbols are in tree.h, the rows in tree_data.h. A vector is one Lanes.
//
// In a chain each row waits for the one before it, so the work from row to row is kept short. The longest
// part is the elimination of the axis. A row is therefore moved to its parent's point before its axis is
// eliminated, not after. With X^T the move of a velocity to that point,
//   T = X U,   X (I - U D^-1 U^T) X^T = X I X^T - T D^-1 T^T,   U^T (w1, v1) = T^T X^T (w1, v1).
#pragma once

#include "server/dynamics/impulse/lanes/lanes.h"
#include "server/dynamics/impulse/lanes/tree_data.h"

namespace visum::dynamics::impulse {
namespace {

// Matrices by cyclic diagonals. The third one of a symmetric matrix is after_next() of its second.
struct LanesSymmetric {
  Lanes diagonal, off;
};
struct LanesMatrix {
  Lanes d0, d1, d2;
};
struct LanesInertia {
  LanesSymmetric A;
  LanesMatrix B;
  LanesSymmetric C;
};
struct LanesPair {
  Lanes w, v;
};

VISUM_LANES_INLINE LanesSymmetric operator+(LanesSymmetric a, LanesSymmetric b) {
  return {a.diagonal + b.diagonal, a.off + b.off};
}
VISUM_LANES_INLINE LanesMatrix operator+(LanesMatrix a, LanesMatrix b) {
  return {a.d0 + b.d0, a.d1 + b.d1, a.d2 + b.d2};
}
VISUM_LANES_INLINE LanesInertia operator+(const LanesInertia& a, const LanesInertia& b) {
  return {a.A + b.A, a.B + b.B, a.C + b.C};
}
VISUM_LANES_INLINE LanesPair operator+(LanesPair a, LanesPair b) {
  return {a.w + b.w, a.v + b.v};
}

VISUM_LANES_INLINE Lanes times(const LanesSymmetric& m, Lanes u) {  // M u
  return m.diagonal * u + (m.off * next(u) + after_next(m.off * u));
}
VISUM_LANES_INLINE Lanes times(const LanesMatrix& m, Lanes u) {
  return m.d0 * u + (m.d1 * next(u) + m.d2 * after_next(u));
}
VISUM_LANES_INLINE Lanes transposed_times(const LanesMatrix& m, Lanes u) {  // M^T u
  return m.d0 * u + (after_next(m.d1 * u) + next(m.d2 * u));
}
VISUM_LANES_INLINE LanesPair times(const LanesInertia& m, LanesPair u) {
  return {times(m.A, u.w) + times(m.B, u.v), transposed_times(m.B, u.w) + times(m.C, u.v)};
}

VISUM_LANES_INLINE LanesInertia load_inertia(const TreeFactor& f) {
  return {
      {load(f.A[0]), load(f.A[1])}, {load(f.B[0]), load(f.B[1]), load(f.B[2])}, {load(f.C[0]), load(f.C[1])}};
}
VISUM_LANES_INLINE void store_inertia(TreeFactor& f, const LanesInertia& m) {
  store(f.A[0], m.A.diagonal);
  store(f.A[1], m.A.off);
  store(f.B[0], m.B.d0);
  store(f.B[1], m.B.d1);
  store(f.B[2], m.B.d2);
  store(f.C[0], m.C.diagonal);
  store(f.C[1], m.C.off);
}
VISUM_LANES_INLINE LanesInertia no_inertia() {
  const Lanes none = all(0.0);
  return {{none, none}, {none, none, none}, {none, none}};
}

// Adds a body whose centre of mass is at c, seen from the point: A = I + m (c.c E - c c^T), B = [m c]x, C = m
// E.
VISUM_LANES_INLINE LanesInertia with_body(const LanesInertia& m, double mass, const double* inertia,
                                          Lanes c) {
  const Lanes lever = mass * c, far = dot(lever, c);
  const Lanes diagonal = lanes(inertia[0], inertia[4], inertia[8], 0.0);
  const Lanes off = lanes(inertia[3], inertia[7], inertia[2], 0.0);
  return {{m.A.diagonal + (diagonal + (far - lever * c)), m.A.off + (off - lever * next(c))},
          {m.B.d0, m.B.d1 - after_next(lever), m.B.d2 + next(lever)},
          {m.C.diagonal + all(mass), m.C.off}};
}

// The inertia at the parent's point: B' = B + r x C,  A' = A + r x B'^T + (r x B^T)^T,  C' = C. The diagonals
// of a product r x M are next(r) after_next(d[k+1]) - after_next(r) next(d[k-1]).
VISUM_LANES_INLINE LanesInertia at_parent(const LanesInertia& m, Lanes r) {
  const Lanes r1 = next(r), r2 = after_next(r);
  const auto& [c0, c1] = m.C;
  const LanesMatrix& B = m.B;
  const LanesMatrix M = B + LanesMatrix{r1 * after_next(c1) - r2 * c1, r1 * next(c1) - r2 * next(c0),
                                        r1 * after_next(c0) - r2 * next(c1)};
  return {{m.A.diagonal + (r1 * (M.d2 + B.d2) - r2 * (M.d1 + B.d1)),
           m.A.off + ((r1 * next(M.d1) - r2 * next(M.d0)) + (r2 * B.d0 - r * B.d2))},
          M,
          m.C};
}

// I - T D^-1 T^T: the axis' freedom taken out.
VISUM_LANES_INLINE LanesInertia without_axis(const LanesInertia& m, LanesPair T, double inverse_D) {
  const Lanes gw = inverse_D * T.w, gv = inverse_D * T.v, w1 = next(T.w), v1 = next(T.v);
  return {{m.A.diagonal - gw * T.w, m.A.off - gw * w1},
          {m.B.d0 - gw * T.v, m.B.d1 - gw * v1, m.B.d2 - gw * after_next(T.v)},
          {m.C.diagonal - gv * T.v, m.C.off - gv * v1}};
}

// P of a row; a free root's is the centre of mass.
VISUM_LANES_INLINE const double* point_of(const TreePlace& place, const TreeRow& row) {
  return row.root >= 0 ? place.x + 3 * static_cast<std::size_t>(row.body)
                       : place.points + place.point_stride * static_cast<std::size_t>(row.node);
}

// The effective 1/D and the gain of an axis, with or without a drive in the tree.
VISUM_LANES_INLINE void divide(TreeFactor& f, const TreeAxis* axis) {
  f.implicit = axis != nullptr && axis->implicit;
  if (f.implicit) {
    const double divisor = 1.0 + axis->compliance * f.D;
    f.inverse_D = axis->compliance / divisor;
    f.gain = 1.0 / divisor;
  } else {
    f.inverse_D = 1.0 / f.D;
    f.gain = 0.0;
  }
}

// The inertia m as the parent feels it. A row without an axis keeps S = T = 0.
VISUM_LANES_INLINE LanesInertia eliminate(const TreePlace& place, const TreeRow& row, TreeFactor& f,
                                          const LanesInertia& m, Lanes r) {
  const LanesInertia moved = at_parent(m, r);
  if (row.axis < 0) return moved;
  const auto node = static_cast<std::size_t>(row.node);
  const std::size_t at = place.free_stride * node + 3 * static_cast<std::size_t>(row.axis);
  const LanesPair S{load3(place.free_w + at), load3(place.free_v + at)};
  LanesPair U{times(m.A, S.w), transposed_times(m.B, S.w)};
  Lanes D = S.w * U.w;
  if (!is_zero(S.v)) {  // the axis does not only turn
    U = U + LanesPair{times(m.B, S.v), times(m.C, S.v)};
    D = S.w * U.w + S.v * U.v;
  }
  f.D = first(sum3(D));
  const LanesPair T{U.w + cross(r, U.v), U.v};
  divide(f, row.alone ? place.axes + node : nullptr);
  store(f.Sw, S.w);
  store(f.Sv, S.v);
  store(f.Tw, T.w);
  store(f.Tv, T.v);
  return without_axis(moved, T, f.inverse_D);
}

// Factors all rows, from the tips to the root.
void factor_tree(const TreeRow* rows, TreeFactor* factors, TreePlace place, std::size_t count) {
  LanesInertia m = no_inertia();  // of what hangs on the row
  Lanes p = all(0.0);
  for (std::size_t i = count; i-- > 0;) {
    const TreeRow& row = rows[i];
    TreeFactor& f = factors[i];
    // A new chain begins at a tip.
    if (row.tip) {
      m = no_inertia();
      p = load3(point_of(place, row));
    }
    // Branches that end here, and the row's own body.
    if (row.collects) m = m + load_inertia(f);
    if (row.body >= 0) {
      const auto body = static_cast<std::size_t>(row.body);
      const Lanes c = load3(place.x + 3 * body) - p;
      store(f.c, c);
      m = with_body(m, row.mass, place.inertia + 9 * body, c);
    }
    // Moved to the parent's point, without the axis' freedom.
    const Lanes up_p = row.parent < 0 ? p : load3(point_of(place, rows[row.parent])), r = p - up_p;
    store(f.r, r);
    m = eliminate(place, row, f, m, r);
    store_inertia(f, m);
    p = up_p;
    if (row.way == TreeRow::kOn || row.way == TreeRow::kNowhere) continue;
    TreeFactor& up = factors[row.parent];
    store_inertia(up, row.way == TreeRow::kSet ? m : load_inertia(up) + m);
  }
}

VISUM_LANES_INLINE LanesPair load_pair(const TreeLoad& from) {
  return {load(from.w), load(from.v)};
}
VISUM_LANES_INLINE void store_pair(TreeLoad& to, LanesPair from) {
  store(to.w, from.w);
  store(to.v, from.v);
}

VISUM_LANES_INLINE LanesPair no_pair() {
  return {all(0.0), all(0.0)};
}

// Passes a row's load on: returns it for the next row, or adds it to a sum in memory and returns zero.
VISUM_LANES_INLINE LanesPair hand_on(const TreeData& tree, const TreeRow& row, LanesPair given) {
  if (row.way == TreeRow::kOn) return given;
  if (row.way != TreeRow::kNowhere) {
    TreeLoad& up = tree.loads[row.parent];
    store_pair(up, row.way == TreeRow::kSet ? given : load_pair(up) + given);
  }
  return no_pair();
}

// From the tips to the root: t = -D^-1 (S^T p - lambda) + gain b,  f = X (I (beta, alpha) + p + U t), which
// goes to the parent.
void load_tree(TreeData tree, std::size_t begin, std::size_t end) {
  LanesPair p = no_pair();  // of what hangs on the row
  for (std::size_t i = end; i-- > begin;) {
    const TreeRow& row = tree.rows[i];
    const TreeFactor& f = tree.factors[i];
    const TreeAsked& asked = tree.asked[i];
    TreeAnswer& answer = tree.answers[i];
    const Lanes r = load(f.r), beta = load(asked.beta), alpha = load(asked.alpha) + cross(r, beta);
    store(answer.alpha, alpha);
    const LanesPair held = times(load_inertia(f), {beta, alpha});
    const double inverse_D = f.inverse_D;
    const Lanes known = all(f.gain * asked.target + inverse_D * asked.axis_impulse);
    if (asked.pushed) {
      const Lanes linear = load(asked.linear);
      p = {p.w - (load(asked.angular) + cross(load(f.c), linear)), p.v - linear};
    }
    // The load of branches that end here.
    if (row.sums) {
      if (row.collects) p = p + load_pair(tree.loads[i]);
      store_pair(tree.loads[i], p);
    }
    const Lanes s = sum3(load(f.Sw) * p.w + load(f.Sv) * p.v), t = known - inverse_D * s;
    answer.rate = first(t);
    answer.axis_load = first(s);
    p = {(held.w + (p.w + cross(r, p.v))) + t * load(f.Tw), (held.v + p.v) + t * load(f.Tv)};
    p = hand_on(tree, row, p);
  }
}

VISUM_LANES_INLINE LanesPair load_of(const TreeData& tree, const TreePush& push) {
  if (push.row < 0) return no_pair();
  const Lanes linear = load(push.linear);
  return {-(load(push.angular) + cross(load(tree.factors[push.row].c), linear)), -linear};
}

// The loads of up to four impulses, one in each lane.
struct LanesLoads {
  Lanes w[3], v[3], axis;
};
VISUM_LANES_INLINE LanesLoads loads_of(const TreeData& tree, const TreePush* pushes, std::size_t count) {
  double w[4][4] = {}, v[4][4] = {}, axis[4] = {};
  for (std::size_t i = 0; i < count; ++i) {
    const LanesPair load = load_of(tree, pushes[i]);
    store(w[i], load.w);
    store(v[i], load.v);
    axis[i] = pushes[i].axis;
  }
  LanesLoads loads;
  for (int k = 0; k < 3; ++k) {
    loads.w[k] = lanes(w[0][k], w[1][k], w[2][k], w[3][k]);
    loads.v[k] = lanes(v[0][k], v[1][k], v[2][k], v[3][k]);
  }
  loads.axis = load(axis);
  return loads;
}

// f = X (p + U t), as in load_tree(), in all lanes with the same row. Returns e = lambda - S^T p.
VISUM_LANES_INLINE Lanes carry_on(const TreeFactor& f, LanesLoads& p) {
  Lanes s = f.Sw[0] * p.w[0] + f.Sv[0] * p.v[0];
  for (int k = 1; k < 3; ++k) s = s + (f.Sw[k] * p.w[k] + f.Sv[k] * p.v[k]);
  const Lanes e = p.axis - s, t = f.inverse_D * e;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    p.w[k] = (p.w[k] + (f.r[i] * p.v[j] - f.r[j] * p.v[i])) + f.Tw[k] * t;
  }
  for (int k = 0; k < 3; ++k) p.v[k] = p.v[k] + f.Tv[k] * t;
  p.axis = all(0.0);
  return e;
}

// Follows up to four impulses, all on the same one or two rows, to the root, or to where nothing moves.
// Writes what they give to each axis on the way into the axis' row of `ways`, and the load on a root into the
// root's six rows behind the tree's. Each row is `width` long; the impulses' columns come first. Lists the
// rows of the way and returns their number. Parents come before their children, so the end with the larger
// row goes on first, and both go on together from where they meet.
std::size_t trace_tree(TreeData tree, std::size_t tree_rows, const TreePush* a, const TreePush* b,
                       std::size_t count, double* ways, std::size_t width, std::size_t* way) {
  const TreePush *lead = a->row >= b->row ? a : b, *rest = lead == a ? b : a;
  LanesLoads p = loads_of(tree, lead, count), later = loads_of(tree, rest, count);
  int at = lead->row, waits = rest->row;
  std::size_t length = 0;
  while (at >= 0) {
    if (at == waits) {
      for (int k = 0; k < 3; ++k) {
        p.w[k] = p.w[k] + later.w[k];
        p.v[k] = p.v[k] + later.v[k];
      }
      p.axis = p.axis + later.axis;
      waits = -1;
    }
    const TreeRow& row = tree.rows[at];
    if (row.root >= 0) {
      double* load = ways + (tree_rows + 6 * static_cast<std::size_t>(row.root)) * width;
      for (std::size_t k = 0; k < 3; ++k) {
        store(load + k * width, p.w[k]);
        store(load + (3 + k) * width, p.v[k]);
      }
    }
    const Lanes e = carry_on(tree.factors[at], p);
    if (row.axis >= 0) {
      way[length++] = static_cast<std::size_t>(at);
      store(ways + static_cast<std::size_t>(at) * width, e);
    }
    at = row.parent;
    if (at >= waits) continue;
    const LanesLoads swapped = p;
    p = later;
    later = swapped;
    const int next_row = waits;
    waits = at;
    at = next_row;
  }
  return length;
}

// to_j = sum of factor_k ways[row_k][j], for j < n. Each row of `ways` is `width` long, at least n + 3.
void sum_ways(const double* ways, std::size_t width, const WayTerm* terms, std::size_t count, std::size_t n,
              double* to) {
  for (std::size_t j = 0; j < n; j += 4) {
    Lanes sum = all(0.0);
    for (std::size_t k = 0; k < count; ++k)
      sum = sum + terms[k].factor * load(ways + terms[k].row * width + j);
    if (j + 4 <= n) {
      store(to + j, sum);
      continue;
    }
    double last[4];
    store(last, sum);
    for (std::size_t i = j; i < n; ++i) to[i] = last[i - j];
  }
}

// From the root to the tips: q' = t - D^-1 U^T (w1, v1), with (w1, v1) the velocity of P before the axis
// moves.
void spread_tree(TreeData tree, std::size_t begin, std::size_t end) {
  LanesPair up = no_pair();
  for (std::size_t i = begin; i < end; ++i) {
    const TreeRow& row = tree.rows[i];
    const TreeFactor& f = tree.factors[i];
    TreeAnswer& answer = tree.answers[i];
    // A row that does not follow its parent directly reads the parent's velocity from memory.
    if (row.way != TreeRow::kOn) {
      const TreeAnswer* from = row.root >= 0     ? &answer
                               : row.parent >= 0 ? tree.answers + row.parent
                                                 : nullptr;
      up = no_pair();
      if (from != nullptr) up = {load(from->w), load(from->v)};
    }
    const Lanes w1 = up.w + load(tree.asked[i].beta), v = up.v + load(answer.alpha);  // v: at the parent's P
    const Lanes e = sum3(load(f.Tw) * w1 + load(f.Tv) * v);
    const Lanes rate = all(answer.rate) - f.inverse_D * e;
    up = {w1 + rate * load(f.Sw), (v + cross(w1, load(f.r))) + rate * load(f.Sv)};
    store(answer.w, up.w);
    store(answer.v, up.v);
    store(answer.dv, up.v + cross(up.w, load(f.c)));
    answer.rate = first(rate);
    answer.axis_load += first(e);
  }
}

VISUM_LANES_INLINE void apply_row(const TreeRow& row, Lanes dv, Lanes dw, double* v, double* w) {
  const std::size_t at = 3 * static_cast<std::size_t>(row.body);
  store3(v + at, load3(v + at) + dv);
  store3(w + at, load3(w + at) + dw);
}

// Adds the answers to the bodies' velocities.
void apply_tree(const TreeRow* rows, const TreeAnswer* answers, std::size_t count, double* v, double* w) {
  for (std::size_t i = 0; i < count; ++i)
    if (rows[i].body >= 0) apply_row(rows[i], load(answers[i].dv), load(answers[i].w), v, w);
}

// Does the same, and adds what the joints give in it to `given`, by node. From the tips to the root: a joint
// gives what all bodies beyond it got, less what was pushed on them.
void apply_and_note_tree(TreeData tree, const double* inertia, std::size_t count, double* v, double* w,
                         double* given) {
  LanesPair f = no_pair();  // of what hangs on the row
  for (std::size_t i = count; i-- > 0;) {
    const TreeRow& row = tree.rows[i];
    if (row.collects) f = f + load_pair(tree.loads[i]);
    if (row.body >= 0) {
      const double* I = inertia + 9 * static_cast<std::size_t>(row.body);
      const Lanes dv = load(tree.answers[i].dv), dw = load(tree.answers[i].w);
      apply_row(row, dv, dw, v, w);
      Lanes linear = row.mass * dv;
      Lanes angular = load(I) * each<0>(dw) + (load(I + 3) * each<1>(dw) + load3(I + 6) * each<2>(dw));
      if (tree.asked[i].pushed) {
        linear = linear - load(tree.asked[i].linear);
        angular = angular - load(tree.asked[i].angular);
      }
      f = f + LanesPair{angular + cross(load(tree.factors[i].c), linear), linear};
      double* to = given + 6 * static_cast<std::size_t>(row.node);
      store6(to, load(to) + f.w, load3(to + 3) + f.v);
    }
    f.w = f.w + cross(load(tree.factors[i].r), f.v);
    f = hand_on(tree, row, f);
  }
}

double largest_answer_of_tree(const TreeAnswer* answers, std::size_t count) {
  Lanes largest = all(0.0);
  for (std::size_t i = 0; i < count; ++i) {
    largest = larger(magnitude(load(answers[i].w)), largest);
    largest = larger(magnitude(load(answers[i].dv)), largest);
  }
  return first(larger(each<2>(largest), larger(each<1>(largest), largest)));
}

}  // namespace
}  // namespace visum::dynamics::impulse
