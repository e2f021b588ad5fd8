// The kernels of bodies and joints: both builds give the same bits, and the right numbers.
#include "server/dynamics/impulse/lanes/kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <span>

namespace visum::dynamics::impulse {
namespace {

constexpr std::size_t kBodies = 4;

// The bodies of a block, and four hinges, each hanging on the next one.
struct Four {
  explicit Four(std::uint64_t seed, bool top, bool aligned) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> range(-1.0, 1.0);
    const auto fill = [&](std::span<double> to) {
      for (double& number : to) number = range(random);
    };
    for (auto* vectors : {&x, &v, &w}) fill(*vectors);
    fill(dv_dw);
    block.top = top;
    block.aligned = aligned;
    for (std::size_t i = 0; i < kBodies; ++i) {
      const Eigen::Vector4d q_WB =
          Eigen::Vector4d(range(random), range(random), range(random), 2.0).normalized();
      const Eigen::Vector4d q_BP =
          Eigen::Vector4d(range(random), range(random), range(random), 2.0).normalized();
      for (std::size_t k = 0; k < 4; ++k) {
        q_WB_[4 * i + k] = q_WB[static_cast<int>(k)];
        block.q_BP[k][i] = aligned ? (k == 3 ? 1.0 : 0.0) : q_BP[static_cast<int>(k)];
      }
      for (std::size_t k = 0; k < 3; ++k) {
        block.moments[k][i] = top && k == 1 ? block.moments[0][i] : 1.5 + range(random);
        block.inverse_moments[k][i] = 1.0 / block.moments[k][i];
        for (auto* point : {&joint.point_a, &joint.axis_a, &joint.point_b, &joint.axis_b})
          (*point)[k][i] = range(random);
      }
      const auto number = static_cast<long>(i), next = static_cast<long>((i + 1) % kBodies);
      block.vector[i] = joint.vector_b[i] = 3 * number;
      block.quaternion[i] = 4 * number;
      block.matrix[i] = joint.matrix_b[i] = 9 * number;
      block.answer[i] = 6 * number;
      joint.vector_a[i] = 3 * next;
      joint.matrix_a[i] = 9 * next;
      joint.pose[i] = 12 * number;
      joint.free[i] = 3 * number;
      joint.impulse[i] = 6 * number;
      joint.request[i] = 8 * number;
      joint.node[i] = number;
    }
  }

  BodyArrays arrays() {
    return {x.data(),     v.data(),  w.data(),       q.data(),
            q_WB_.data(), R.data(),  inertia.data(), inverse_inertia.data(),
            x1.data(),    q1.data(), R1.data()};
  }

  // A step's kernels one after the other.
  void run(const Kernels& kernels, double h) {
    const BodyArrays of = arrays();
    const double gravity[3] = {0.1, -0.2, -9.81};
    double *beta = asked.data(), *alpha = asked.data() + 4;
    kernels.orient(of, &block, 1);
    kernels.place_hinges(of.x, of.R, &joint, 1, poses.data(), free.data());
    kernels.free_hinges_impulses(&joint, 1, poses.data(), impulses.data(), shares.data());
    kernels.fly(of, &block, 1, h, gravity);
    gap = kernels.ask_hinges_gaps(of.x1, of.R1, &joint, 1, h, poses.data(), {beta, alpha});
    kernels.nudge(of, &block, 1, h, dv_dw.data(), dv_dw.data() + 3);
    turn = kernels.largest_turn(of, &block, 1);
    moved = kernels.commit(of, &block, 1, h, gravity);
    kernels.place_joints(of.x, of.R, &joint, 1, poses.data());
    kernels.ask_hinges_velocities(of, &joint, 1, poses.data(), {beta, alpha});
  }

  bool operator==(const Four& other) const {
    return std::tie(x, v, w, q, q_WB_, R, inertia, inverse_inertia, x1, q1, R1, poses, free, impulses, shares,
                    asked, gap, turn, moved) ==
           std::tie(other.x, other.v, other.w, other.q, other.q_WB_, other.R, other.inertia,
                    other.inverse_inertia, other.x1, other.q1, other.R1, other.poses, other.free,
                    other.impulses, other.shares, other.asked, other.gap, other.turn, other.moved);
  }

  BodyBlock block;
  JointBlock joint;
  std::vector<double> x = zeros(3), v = x, w = x, x1 = x;
  std::vector<double> q = zeros(4), q_WB_ = q, q1 = q;
  std::vector<double> R = zeros(9), R1 = R, inertia = R, inverse_inertia = R;
  std::vector<double> poses = zeros(12), free = zeros(3), impulses = std::vector<double>(6 * kBodies, 0.25);
  std::vector<double> shares = zeros(1), asked = zeros(8), dv_dw = zeros(6);
  double gap = 0.0, turn = 0.0;
  bool moved = false;

 private:
  static std::vector<double> zeros(std::size_t size) { return std::vector<double>(size * kBodies); }
};

TEST(Kernels, OfBodiesAndJointsGiveTheSameBitsInBothBuilds) {
  if (kWideKernels == nullptr || &kernels() != kWideKernels) GTEST_SKIP() << "one build alone";
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (const bool top : {false, true})
      for (const bool aligned : {false, true})
        for (const double h : {1e-3, 0.05, 3.0}) {  // the last turns by more than a quarter
          Four baseline(seed, top, aligned), wide(seed, top, aligned);
          baseline.run(kBaselineKernels, h);
          wide.run(*kWideKernels, h);
          EXPECT_TRUE(baseline == wide) << seed << ' ' << top << ' ' << aligned << ' ' << h;
        }
}

Eigen::Vector3d vector(const std::vector<double>& of, std::size_t i) {
  return Eigen::Map<const Eigen::Vector3d>(of.data() + 3 * i);
}
Eigen::Matrix3d matrix(const std::vector<double>& of, std::size_t i) {
  return Eigen::Map<const Eigen::Matrix3d>(of.data() + 9 * i);
}

TEST(Kernels, AFlightKeepsTheMomentumAndTheInertiasMoments) {
  for (const bool top : {false, true})
    for (const bool aligned : {false, true}) {
      Four four(7, top, aligned);
      const BodyArrays of = four.arrays();
      const double gravity[3] = {0.0, 0.0, 0.0};
      kernels().orient(of, &four.block, 1);
      std::vector<Eigen::Vector3d> momentum;
      for (std::size_t i = 0; i < kBodies; ++i)
        momentum.push_back(matrix(four.inertia, i) * vector(four.w, i));
      kernels().fly(of, &four.block, 1, 0.3, gravity);
      EXPECT_TRUE(kernels().commit(of, &four.block, 1, 0.3, gravity));
      for (std::size_t i = 0; i < kBodies; ++i) {
        EXPECT_LT((matrix(four.inertia, i) * vector(four.w, i) - momentum[i]).norm(), 1e-14);
        EXPECT_LT(
            (matrix(four.inertia, i) * matrix(four.inverse_inertia, i) - Eigen::Matrix3d::Identity()).norm(),
            1e-14);
        const double trace = four.block.moments[0][i] + four.block.moments[1][i] + four.block.moments[2][i];
        EXPECT_NEAR(matrix(four.inertia, i).trace(), trace, 1e-14);
      }
    }
}

TEST(Kernels, WhatStandsHasNotMoved) {
  Four four(3, false, true);
  const BodyArrays of = four.arrays();
  const double gravity[3] = {0.0, 0.0, 0.0};
  kernels().orient(of, &four.block, 1);
  four.x1 = four.x;
  four.q1 = four.q_WB_;
  EXPECT_FALSE(kernels().commit(of, &four.block, 1, 1e-3, gravity));
  four.x1[5] = std::nextafter(four.x1[5], 2.0);
  EXPECT_TRUE(kernels().commit(of, &four.block, 1, 1e-3, gravity));
}

// A gap that is not a number must not count as a small gap.
TEST(Kernels, AGapThatIsNoNumberIsSeen) {
  Four four(5, true, true);
  const BodyArrays of = four.arrays();
  kernels().orient(of, &four.block, 1);
  four.x[7] = std::nan("");
  const double gap = kernels().ask_hinges_gaps(of.x, of.R, &four.joint, 1, 1e-3, four.poses.data(),
                                               {four.asked.data(), four.asked.data() + 4});
  EXPECT_TRUE(std::isnan(gap));
}

}  // namespace
}  // namespace visum::dynamics::impulse
