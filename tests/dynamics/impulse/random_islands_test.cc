// The solver of rows with bounds on islands made at random: one or two mechanisms and up to three free
// bodies, with contacts between any two of them and with the world, rolling friction, and rows with two
// bounds.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/dynamics/impulse/own_island.h"

namespace visum::dynamics::impulse {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kInertia = 0.01;  // kg m2 for each kg

class RandomIsland {
 public:
  RandomIsland(unsigned seed, const Rows& rows) : random_(seed), rows_(rows) {
    mechanisms_.resize(1 + below(2));
    for (Mechanism& mechanism : mechanisms_) {
      const auto size = static_cast<Eigen::Index>(6 + below(6));
      mechanism.velocity = VectorXd::NullaryExpr(size, [&] { return 0.05 * any(); });
      mechanism.inverse_mass = VectorXd::NullaryExpr(size, [&] { return 2.7 + 2.5 * any(); });
    }
    for (std::size_t free = below(4); free > 0; --free) {
      const double mass = 0.6 + 0.5 * any();
      own_.bodies.push_back({mass, {kInertia * mass, 0, 0, 0, kInertia * mass, 0, 0, 0, kInertia * mass}});
      for (int i = 0; i < 6; ++i) own_.velocities.push_back(0.05 * any());
    }
    const bool rolls = below(3) == 0;
    for (std::size_t contact = 1 + below(seed % 10 == 0 ? 40 : 9); contact > 0; --contact) add_contact(rolls);
    respond();
    start_ = own_.velocities;
    calm_ = below(2) == 0;
  }

  struct Result {
    std::vector<double> numbers;  // impulses and velocities
    double gap = 0.0;  // largest difference between velocities and what the impulses make them, m/s
    bool operator==(const Result&) const = default;
  };

  // Solves it three times, with other targets and bounds each time, then gives it a few gentle sweeps.
  Result solve(Rows& rows) {
    Result result;
    own_.prepare(rows);
    if (calm_) own_.set_calm();
    for (int time = 0; time < 4; ++time) {
      if (time < 3) {
        own_.solve(rows, 100);
      } else {
        rows.soften(1.0);
        rows.sweep_gently(5);
      }
      for (const RowBlock& block : own_.blocks)
        result.numbers.insert(result.numbers.end(), block.lambda.begin(), block.lambda.end());
      result.numbers.insert(result.numbers.end(), own_.velocities.begin(), own_.velocities.end());
      result.gap = std::max(result.gap, gap());
      for (RowBlock& block : own_.blocks) {
        if (time == 0) block.target[0] += 0.01 * any();
        if (time == 1 && block.kind == RowBlock::Kind::kContact)
          block.low = 0.5 * std::max(0.0, block.lambda[0]);
      }
    }
    return result;
  }

 private:
  struct Mechanism {
    VectorXd velocity, inverse_mass;
    std::vector<VectorXd> rows;  // directions
  };

  double any() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  std::size_t below(std::size_t count) { return random_() % count; }

  // With one or two of the mechanisms and bodies; sometimes with rolling friction and a row with bounds.
  void add_contact(bool rolls) {
    const std::size_t parts = mechanisms_.size() + own_.bodies.size();
    const std::size_t a = below(parts), b = below(parts);
    const bool alone = a == b || below(3) == 0;
    RowBlock block = block_of(RowBlock::Kind::kContact, 3);
    block.friction = below(5) == 0 ? 0.0 : 0.65 + 0.35 * any();
    block.give = below(2) == 0 ? kGive : 0.0;
    block.lambda[0] = 0.005 + 0.005 * any();
    if (below(2) == 0) {
      const double angle = 3.0 * any(), held = block.friction * block.lambda[0];
      block.lambda = {block.lambda[0], held * std::cos(angle), held * std::sin(angle)};
    }
    if (below(4) == 0) {
      block.low = -0.002 + 0.002 * any();
      block.base = {0.0015 - block.low + 0.0015 * any(), 0.0, 0.0};
    }
    connect(block, a, 1.0);
    if (!alone) connect(block, b, -1.0);
    own_.blocks.push_back(block);
    if (rolls && below(2) == 0) {
      RowBlock twist = block_of(RowBlock::Kind::kTwist, 3);
      twist.contact = own_.blocks.size() - 1;
      twist.friction = twist.torsion = 0.01;
      connect(twist, a, 1.0);
      if (!alone) connect(twist, b, -1.0);
      own_.blocks.push_back(twist);
    }
    if (below(3) == 0) {
      RowBlock stop = block_of(RowBlock::Kind::kBounded, 1);
      stop.low = below(2) == 0 ? 0.0 : -0.01;
      stop.high = 0.01;
      stop.target[0] = 0.02 * any();
      connect(stop, below(mechanisms_.size()), 1.0);
      own_.blocks.push_back(stop);
    }
  }

  static RowBlock block_of(RowBlock::Kind kind, std::size_t dim) {
    RowBlock block;
    block.kind = kind;
    block.dim = dim;
    block.free_response = 1.0;
    return block;
  }

  // Gives the block an end on a mechanism, or on a body after them.
  void connect(RowBlock& block, std::size_t part, double sign) {
    RowEnd& end = block.ends[block.end_count++];
    end.free = part >= mechanisms_.size();
    if (!end.free) {
      Mechanism& mechanism = mechanisms_[part];
      end.mechanism = part;
      end.first = mechanism.rows.size();
      for (std::size_t i = 0; i < block.dim; ++i)
        mechanism.rows.push_back(VectorXd::NullaryExpr(mechanism.velocity.size(), [&] { return any(); }));
      return;
    }
    const std::size_t body = part - mechanisms_.size();
    end.offset = 6 * body;
    const Vector3d normal = Vector3d(any(), any(), any()).normalized(), aside = normal.unitOrthogonal();
    const Vector3d lever = 0.1 * Vector3d(any(), any(), any());
    const bool turns = block.kind == RowBlock::Kind::kTwist;
    for (std::size_t i = 0; const Vector3d& along : {normal, aside, Vector3d(normal.cross(aside))}) {
      const Vector3d angular = turns ? along : lever.cross(along), linear = turns ? Vector3d::Zero() : along;
      for (int k = 0; k < 3; ++k) {
        end.J[i][static_cast<std::size_t>(k)] = sign * angular[k];
        end.J[i][static_cast<std::size_t>(3 + k)] = sign * linear[k];
      }
      ++i;
    }
    const double mass = own_.bodies[body].mass;
    rows_.respond(block, end, Matrix3d(Matrix3d::Identity() / (kInertia * mass)).data(), 1.0 / mass);
  }

  // The mechanisms' W and velocities, once all rows are known.
  void respond() {
    for (std::size_t m = 0; m < mechanisms_.size(); ++m) {
      const Mechanism& mechanism = mechanisms_[m];
      const std::size_t size = mechanism.rows.size();
      for (RowBlock& block : own_.blocks)
        for (std::size_t e = 0; e < block.end_count; ++e) {
          RowEnd& end = block.ends[e];
          if (end.free || end.mechanism != m) continue;
          end.offset = own_.velocities.size();
          end.size = size;
          end.response = own_.responses.size();
        }
      for (const VectorXd& row : mechanism.rows) own_.velocities.push_back(row.dot(mechanism.velocity));
      for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = 0; j < size; ++j)
          own_.responses.push_back(mechanism.rows[std::max(i, j)]
                                       .cwiseProduct(mechanism.inverse_mass)
                                       .dot(mechanism.rows[std::min(i, j)]));
    }
  }

  double gap() const {
    std::vector<double> expected = start_;
    for (const RowBlock& block : own_.blocks)
      for (std::size_t e = 0; e < block.end_count; ++e) {
        const RowEnd& end = block.ends[e];
        for (std::size_t i = 0; i < block.dim; ++i)
          for (std::size_t k = 0; k < (end.free ? 6 : end.size); ++k)
            expected[end.offset + k] +=
                block.lambda[i] *
                (end.free ? end.MJ[i][k] : own_.responses[end.response + (end.first + i) * end.size + k]);
      }
    double largest = 0.0;
    for (std::size_t i = 0; i < expected.size(); ++i)
      largest = std::max(largest, std::abs(expected[i] - own_.velocities[i]));
    return largest;
  }

  std::mt19937_64 random_;
  const Rows& rows_;
  std::vector<Mechanism> mechanisms_;
  OwnIsland own_;
  std::vector<double> start_;  // velocities
  bool calm_ = false;
};

// Whatever the rows are, velocities are those that the impulses make, and a solver that has solved others
// before has the same bits as a new one, with both kinds of kernels.
TEST(RandomIslands, KeepVelocitiesAndBits) {
  const bool has_wide = kWideKernels != nullptr && __builtin_cpu_supports("avx2");
  Rows used, used_wide(has_wide ? *kWideKernels : kBaselineKernels);
  for (unsigned seed = 0; seed < 1000; ++seed) {
    Rows fresh, baseline(kBaselineKernels);
    RandomIsland island(seed, fresh);
    const RandomIsland same = island;
    const RandomIsland::Result result = island.solve(fresh);
    for (const double number : result.numbers) ASSERT_TRUE(std::isfinite(number)) << seed;
    ASSERT_LT(result.gap, 1e-9) << seed;
    for (Rows* rows : {&used, &used_wide, &baseline}) {
      RandomIsland again = same;
      ASSERT_TRUE(again.solve(*rows) == result) << seed;
    }
  }
}

}  // namespace
}  // namespace visum::dynamics::impulse
