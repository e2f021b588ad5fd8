// Rows on free bodies, solved for the bodies, give the impulses of the rows' own system.
#include "server/dynamics/impulse/body_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "server/dynamics/impulse/envelope_lu.h"

namespace visum::dynamics::impulse {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

using Pairs = std::vector<std::array<std::size_t, 2>>;

struct Lines {
  std::vector<FreeBody> bodies;
  Pairs ends;
  MatrixXd J, P, M;  // row by row: J, P; mass
  VectorXd softness, missing;
};

// A chain of bodies: two rows between neighbours, one more across a body, and one to the ground.
Pairs chain(std::size_t count) {
  Pairs ends;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    for (int twice = 0; twice < 2; ++twice) ends.push_back({i, i + 1});
    if (i + 2 < count) ends.push_back({i, i + 2});
  }
  ends.push_back({0, 0});
  return ends;
}

// Neighbours in a square, with a hub that touches every third one, each pair either way round.
Pairs square_with_hub(std::size_t side) {
  Pairs ends;
  const std::size_t hub = side * side;
  for (std::size_t i = 0; i < hub; ++i) {
    if (i % side + 1 < side) ends.push_back({i, i + 1});
    if (i + side < hub) ends.push_back({i + side, i});
    if (i % 3 == 0) ends.push_back({i, hub});
  }
  return ends;
}

Lines make_rows(std::size_t count, const Pairs& ends, double drag) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Lines rows;
  rows.ends = ends;
  const auto m = static_cast<Eigen::Index>(rows.ends.size()), n = static_cast<Eigen::Index>(6 * count);
  rows.J = rows.P = MatrixXd::Zero(m, n);
  rows.M = MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < count; ++i) {
    const double mass = 1.0 + 10.0 * static_cast<double>(i % 3);
    rows.bodies.push_back({mass, {2.0, 0.3, 0.1, 0.3, 3.0, 0.2, 0.1, 0.2, 4.0}});
    const auto at = static_cast<Eigen::Index>(6 * i);
    rows.M.block<3, 3>(at, at) = Eigen::Map<const Eigen::Matrix3d>(rows.bodies[i].inertia.data());
    rows.M.block<3, 3>(at + 3, at + 3).diagonal().setConstant(mass);
  }
  for (Eigen::Index r = 0; r < m; ++r) {
    for (const std::size_t body : rows.ends[static_cast<std::size_t>(r)]) {
      for (Eigen::Index k = 0; k < 6; ++k) {
        const Eigen::Index column = static_cast<Eigen::Index>(6 * body) + k;
        rows.J(r, column) = uniform(generator);
        rows.P(r, column) = rows.J(r, column) + drag * uniform(generator);
      }
    }
  }
  rows.softness = VectorXd::Constant(m, 1e-4);
  rows.missing = VectorXd::NullaryExpr(m, [&] { return uniform(generator); });
  return rows;
}

std::vector<BodyRow> body_rows(const Lines& lines) {
  std::vector<BodyRow> rows(lines.ends.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const auto line = static_cast<Eigen::Index>(r);
    const auto& [a, b] = lines.ends[r];
    rows[r].softness = lines.softness[line];
    rows[r].ends = a == b ? 1 : 2;
    for (std::size_t e = 0; e < rows[r].ends; ++e) {
      rows[r].body[e] = lines.ends[r][e];
      for (std::size_t k = 0; k < 6; ++k) {
        const auto column = static_cast<Eigen::Index>(6 * lines.ends[r][e] + k);
        rows[r].measured[e][k] = lines.J(line, column);
        rows[r].pushed[e][k] = lines.P(line, column);
      }
    }
  }
  return rows;
}

// Rows in a row that have the same ends go into the factor together.
// The bodies are connected already.
VectorXd impulses_of_connected(const Lines& lines, bool symmetric, BodyFactor& factor) {
  EXPECT_TRUE(factor.place(symmetric, 100'000));
  const std::vector<BodyRow> rows = body_rows(lines);
  for (std::size_t r = 0; r < rows.size();) {
    std::size_t end = r + 1;
    while (end < rows.size() && end < r + 3 && lines.ends[end] == lines.ends[r]) ++end;
    factor.add(std::span(rows).subspan(r, end - r));
    r = end;
  }
  EXPECT_TRUE(factor.factor());
  VectorXd found = lines.missing;
  factor.solve(rows, {found.data(), rows.size()});
  return found;
}

VectorXd impulses_by_bodies(const Lines& lines, bool symmetric, BodyFactor& factor) {
  factor.start(lines.bodies);
  for (const auto& [a, b] : lines.ends) factor.connect(a, b);
  return impulses_of_connected(lines, symmetric, factor);
}

VectorXd impulses_by_bodies(const Lines& lines, bool symmetric, const Kernels& by = kernels()) {
  BodyFactor factor(by);
  return impulses_by_bodies(lines, symmetric, factor);
}

// (J M^-1 P^T + S) l = r
VectorXd impulses_by_rows(const Lines& lines) {
  MatrixXd response = lines.J * lines.M.inverse() * lines.P.transpose();
  response.diagonal() += lines.softness;
  return response.fullPivLu().solve(lines.missing);
}

TEST(BodyFactor, FindsTheImpulsesOfTheRowsOwnSystem) {
  const Lines rows = make_rows(6, chain(6), 0.0);
  const VectorXd expected = impulses_by_rows(rows);
  EXPECT_LT((impulses_by_bodies(rows, true) - expected).norm(), 1e-8 * expected.norm());
  EXPECT_LT((impulses_by_bodies(rows, false) - expected).norm(), 1e-8 * expected.norm());
}

TEST(BodyFactor, KnowsFrictionThatIsDraggedAlong) {
  const Lines rows = make_rows(6, chain(6), 0.05);
  const VectorXd expected = impulses_by_rows(rows);
  EXPECT_LT((impulses_by_bodies(rows, false) - expected).norm(), 1e-8 * expected.norm());
}

TEST(BodyFactor, SolvesForBodiesThatTouchAllAround) {
  for (const double drag : {0.0, 0.05}) {
    const Lines rows = make_rows(26, square_with_hub(5), drag);
    const VectorXd expected = impulses_by_rows(rows);
    EXPECT_LT((impulses_by_bodies(rows, drag == 0.0) - expected).norm(), 1e-8 * expected.norm());
  }
}

// The same object, with another pattern and back, as islands change from tick to tick.
TEST(BodyFactor, HasTheSameBitsWhateverItSolvedBefore) {
  const Lines rows = make_rows(26, square_with_hub(5), 0.0), other = make_rows(26, chain(26), 0.0);
  BodyFactor used(kernels());
  const VectorXd first = impulses_by_bodies(rows, true, used);
  EXPECT_EQ(impulses_by_bodies(other, true, used), impulses_by_bodies(other, true));
  EXPECT_EQ(impulses_by_bodies(rows, true, used), first);
}

// Other rows are active in each pass, and some drag friction along or no longer do. The bodies stay
// connected.
TEST(BodyFactor, TakesOtherRowsOnTheSameBodies) {
  const Lines all = make_rows(26, square_with_hub(5), 0.0);
  BodyFactor factor(kernels());
  const VectorXd first = impulses_by_bodies(all, true, factor);
  for (const double drag : {0.05, 0.0}) {
    auto ends = square_with_hub(5);
    ends.resize(ends.size() / 2);
    const Lines few = make_rows(26, ends, drag);
    const VectorXd expected = impulses_by_rows(few);
    EXPECT_LT((impulses_of_connected(few, drag == 0.0, factor) - expected).norm(), 1e-8 * expected.norm());
  }
  EXPECT_EQ(impulses_of_connected(all, true, factor), first);
}

TEST(BodyFactor, HasTheSameBitsFromBothKernels) {
  if (kWideKernels == nullptr || !__builtin_cpu_supports("avx2")) GTEST_SKIP() << "no AVX2 here";
  for (const bool symmetric : {true, false}) {
    const Lines rows = make_rows(9, chain(9), symmetric ? 0.0 : 0.05);
    EXPECT_EQ(impulses_by_bodies(rows, symmetric, kBaselineKernels),
              impulses_by_bodies(rows, symmetric, *kWideKernels));
  }
}

TEST(EnvelopeLu, HasTheSameBitsFromBothKernels) {
  if (kWideKernels == nullptr || !__builtin_cpu_supports("avx2")) GTEST_SKIP() << "no AVX2 here";
  constexpr std::size_t kSize = 23;
  const auto solved = [](const Kernels& by) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    EnvelopeLu factor(by);
    for (std::size_t i = 0; i < kSize; ++i) factor.add(i < 11 ? 0 : i - 11);
    factor.place();
    for (std::size_t i = 0; i < kSize; ++i)
      for (std::size_t j = factor.first(i); j <= i; ++j) {
        factor.at(i, j) = uniform(generator);
        factor.at(j, i) = i == j ? 20.0 : uniform(generator);
      }
    std::vector<double> b(kSize, 1.0);
    EXPECT_TRUE(factor.factor());
    factor.solve(b);
    return b;
  };
  EXPECT_EQ(solved(kBaselineKernels), solved(*kWideKernels));
}

// Two systems that differ from row 14 on, and in their number of rows.
TEST(EnvelopeLu, KeepsTheRowsBeforeThoseThatChange) {
  constexpr std::size_t kKept = 14;
  const auto fill = [](EnvelopeLu& factor, std::size_t kept, std::size_t size, int seed) {
    for (std::size_t i = kept; i < size; ++i) factor.add(i < 11 ? 0 : i - 11);
    factor.place();
    for (std::size_t i = kept; i < size; ++i) {
      std::mt19937 generator(static_cast<unsigned>(i < kKept ? i : 100 * static_cast<std::size_t>(seed) + i));
      std::uniform_real_distribution<double> uniform(-1.0, 1.0);
      for (std::size_t j = factor.first(i); j <= i; ++j) {
        factor.at(i, j) = uniform(generator);
        factor.at(j, i) = i == j ? 20.0 : uniform(generator);
      }
    }
    EXPECT_TRUE(factor.factor());
    std::vector<double> b(size, 1.0);
    factor.solve(b);
    return b;
  };
  for (const std::size_t size : {17, 23, 29}) {
    EnvelopeLu kept, anew;
    fill(kept, 0, 23, 1);
    kept.restart(kKept);
    EXPECT_EQ(fill(kept, kKept, size, 2), fill(anew, 0, size, 2)) << size;
  }
}

TEST(BodyFactor, RefusesMoreEntriesThanItMayHave) {
  const Lines rows = make_rows(6, chain(6), 0.0);
  BodyFactor factor;
  factor.start(rows.bodies);
  for (const auto& [a, b] : rows.ends) factor.connect(a, b);
  EXPECT_FALSE(factor.place(true, 36 * 14));
  EXPECT_TRUE(factor.place(true, 36 * 15));  // six on the diagonal, five between neighbours, four across one
}

// A row on one body that pushes along (x, y) and measures along (1, 2).
BodyRow crooked_row(double x, double y) {
  return {1.0, 1, {}, {{0.0, 0.0, 0.0, 1.0, 2.0, 0.0}}, {{0.0, 0.0, 0.0, x, y, 0.0}}};
}

// A body of 1 kg that has this row.
BodyFactor one_body(const BodyRow& row) {
  static const std::vector<FreeBody> bodies{{1.0, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}}};
  BodyFactor factor;
  factor.start(bodies);
  EXPECT_TRUE(factor.place(false, 36));
  factor.add({&row, 1});
  return factor;
}

// Friction that a normal drags along can make the first pivot zero or negative where the whole is sound.
TEST(BodyFactor, SolvesWhereASinglePivotIsNotPositive) {
  for (const double x : {-1.0, -2.0}) {
    const BodyRow row = crooked_row(x, 3.0);
    BodyFactor factor = one_body(row);
    ASSERT_TRUE(factor.factor());
    double impulse = 1.0;
    factor.solve({&row, 1}, {&impulse, 1});
    EXPECT_NEAR(impulse, 1.0 / (1.0 + x + 2.0 * 3.0), 1e-14);  // r/(s + j p)
  }
}

TEST(BodyFactor, SaysWhereABodyCannotBeSolvedFor) {
  EXPECT_FALSE(one_body(crooked_row(-1.0, 0.0)).factor());
}

}  // namespace
}  // namespace visum::dynamics::impulse
