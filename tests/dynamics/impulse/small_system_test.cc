// The system of a few rows, against the same one written out in Eigen.
#include "server/dynamics/impulse/small_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace visum::dynamics::impulse {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Contacts of three rows each on one mechanism; by turns one sticks, slides, and is open. Rows that take part
// push along the columns of `pushed`, and measure along those of `measured`.
struct Contacts {
  explicit Contacts(std::size_t count) : rows(3 * count) {
    std::mt19937 generator(static_cast<unsigned>(count));
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto n = static_cast<Eigen::Index>(rows);
    const MatrixXd some = MatrixXd::NullaryExpr(n, n, [&] { return uniform(generator); });
    responses = some * some.transpose() / static_cast<double>(n) + 0.3 * MatrixXd::Identity(n, n);
    for (std::size_t k = 0; k < count; ++k) {
      if (k % 3 == 2) continue;
      const double along = 0.6, across = 0.8, friction = 0.2;
      if (k % 3 == 0) {
        add({3 * k, SmallRow::Kind::kDrags, {friction * along, friction * across}, 1e-3},
            {1.0, friction * along, friction * across}, {1.0, 0.0, 0.0});
        add({3 * k + 1, SmallRow::Kind::kAcross, {-across, along}, 0.2}, {0.0, -across, along},
            {0.0, -across, along});
      } else {
        for (std::size_t i = 0; i < 3; ++i) {
          Eigen::Vector3d only = Eigen::Vector3d::Zero();
          only[static_cast<int>(i)] = 1.0;
          add({3 * k + i, SmallRow::Kind::kPlain, {}, 1e-3}, only, only);
        }
      }
    }
  }

  void start(SmallSystem& system) const {
    system.start(rows);
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j <= i; ++j) system.set_response(i, j, response(i, j));
    add_rows(system);
  }
  void add_rows(SmallSystem& system) const {
    system.clear();
    for (const SmallRow& row : active) system.add(row);
  }
  double response(std::size_t i, std::size_t j) const {
    return responses(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
  std::vector<double> right_side() const {
    std::vector<double> b(active.size());
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = 1.0 - 0.3 * static_cast<double>(i % 5);
    return b;
  }
  MatrixXd matrix() const {
    MatrixXd A = measured.transpose() * responses * pushed;
    for (std::size_t i = 0; i < active.size(); ++i)
      A(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) += active[i].softness;
    return A;
  }

  std::size_t rows;
  MatrixXd responses, pushed, measured;
  std::vector<SmallRow> active;

 private:
  void add(const SmallRow& row, const Eigen::Vector3d& push, const Eigen::Vector3d& measure) {
    const std::size_t first = row.at - row.at % 3;
    active.push_back(row);
    for (auto [directions, of] : {std::pair(&pushed, &push), std::pair(&measured, &measure)}) {
      directions->conservativeResize(static_cast<Eigen::Index>(rows),
                                     static_cast<Eigen::Index>(active.size()));
      directions->rightCols<1>().setZero();
      directions->rightCols<1>().segment<3>(static_cast<Eigen::Index>(first)) = *of;
    }
  }
};

std::vector<double> solved(const Contacts& contacts, SmallSystem& system) {
  std::vector<double> b = contacts.right_side();
  EXPECT_TRUE(system.factor());
  system.solve(b);
  return b;
}

TEST(SmallSystem, SolvesWhatItsRowsSay) {
  for (const std::size_t count : {1, 2, 3, 4, 5, 7, 12, 32}) {
    const Contacts contacts(count);
    SmallSystem system;
    contacts.start(system);
    const std::vector<double> found = solved(contacts, system), b = contacts.right_side();
    const auto size = static_cast<Eigen::Index>(b.size());
    const VectorXd expected = contacts.matrix().partialPivLu().solve(VectorXd::Map(b.data(), size));
    EXPECT_LT((VectorXd::Map(found.data(), size) - expected).norm(), 1e-11 * expected.norm()) << count;
  }
}

TEST(SmallSystem, TakesWholeRowsOfResponses) {
  const Contacts contacts(5);
  SmallSystem by_entries, by_rows;
  contacts.start(by_entries);
  by_rows.start(contacts.rows);
  for (std::size_t i = 0; i < contacts.rows; ++i) {
    std::vector<double> row(contacts.rows);
    for (std::size_t j = 0; j < contacts.rows; ++j)
      row[j] = contacts.response(std::max(i, j), std::min(i, j));
    by_rows.set_responses(i, row);
  }
  contacts.add_rows(by_rows);
  EXPECT_EQ(solved(contacts, by_entries), solved(contacts, by_rows));
}

// A smaller system after a larger one, and another one after that.
TEST(SmallSystem, KeepsNothingOfTheOneBefore) {
  SmallSystem used;
  for (const std::size_t count : {9, 2, 5}) {
    const Contacts contacts(count);
    SmallSystem fresh;
    contacts.start(used);
    contacts.start(fresh);
    EXPECT_EQ(solved(contacts, used), solved(contacts, fresh)) << count;
  }
}

TEST(SmallSystem, HasTheSameBitsFromBothKernels) {
  if (kWideKernels == nullptr || !__builtin_cpu_supports("avx2")) GTEST_SKIP() << "no AVX2 here";
  for (const std::size_t count : {1, 4, 7, 16}) {
    const Contacts contacts(count);
    SmallSystem baseline(kBaselineKernels), wide(*kWideKernels);
    contacts.start(baseline);
    contacts.start(wide);
    EXPECT_EQ(solved(contacts, baseline), solved(contacts, wide)) << count;
  }
}

TEST(SmallSystem, HasNoFactorWithoutPositivePivots) {
  SmallSystem system;
  system.start(2);
  system.set_response(0, 0, 1.0);
  system.set_response(1, 0, 2.0);
  system.set_response(1, 1, 3.0);
  system.clear();
  for (const std::size_t at : {0, 1}) system.add({at, SmallRow::Kind::kPlain, {}, 0.0});
  EXPECT_FALSE(system.factor());
}

}  // namespace
}  // namespace visum::dynamics::impulse
