// The solver of rows with bounds, given directly, on mechanisms: a box between two fingers of a hand, a
// vehicle on many wheels.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include "tests/dynamics/impulse/own_island.h"

namespace visum::dynamics::impulse {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kGrip = 0.9, kHalf = 0.03;       // m
constexpr double kSqueeze = 0.02, kFall = 15e-3;  // m/s: gained in a millisecond
constexpr std::size_t kCorners = 4, kContacts = 2 * kCorners, kRows = 3 * kContacts;

// Contact k: its corner of the box, and the directions in which the box moves against the finger (normal
// first).
struct Corner {
  explicit Corner(std::size_t k)
      : finger(k / kCorners),
        side(finger == 0 ? 1.0 : -1.0),
        point(k % 2 == 0 ? kHalf : -kHalf, -side * kHalf, k / 2 % 2 == 0 ? 0.5 * kHalf : -0.5 * kHalf),
        axes{Vector3d(0, side, 0), Vector3d(1, 0, 0), Vector3d(0, 0, 1)} {}
  std::size_t finger;
  double side;
  Vector3d point;
  std::array<Vector3d, 3> axes;
};

// The hand moves as a body and is heavy; each finger slides along y.
class Grasp {
 public:
  explicit Grasp(std::mt19937_64& random) {
    std::uniform_real_distribution<double> some(0.0, 1.0), any(-1.0, 1.0);
    VectorXd mass(8), velocity = VectorXd::Zero(8);
    mass << 0.2, 0.3, 0.25, 6.0, 7.0, 5.0, 0.4, 0.4;
    velocity[5] = -kFall * some(random);  // the hand gives way by less than the box
    velocity[6] = kSqueeze;
    velocity[7] = -kSqueeze;
    MatrixXd jacobian(kRows, 8);
    for (std::size_t k = 0; k < kContacts; ++k) {
      const Corner corner(k);
      for (std::size_t i = 0; i < 3; ++i) {
        VectorXd row = VectorXd::Zero(8);
        row.head<3>() = -(corner.point + Vector3d(0, 0, 0.1)).cross(corner.axes[i]);
        row.segment<3>(3) = -corner.axes[i];
        row[6 + static_cast<int>(corner.finger)] = -corner.axes[i].y();
        jacobian.row(static_cast<int>(3 * k + i)) = row;
      }
    }
    jacobian_ = jacobian;
    response_ = jacobian * mass.cwiseInverse().asDiagonal() * jacobian.transpose();
    own_.velocities.assign(6 + kRows, 0.0);
    own_.velocities[5] = -kFall;
    VectorXd::Map(&own_.velocities[6], kRows) = jacobian * velocity;
    own_.responses.assign(response_.data(), response_.data() + response_.size());
    for (std::size_t k = 0; k < kContacts; ++k) add_contact(k, some, any, random);
    own_.prepare(rows_);
  }

  Rows& rows() { return rows_; }
  // The next tick's world: what moves box, hand and fingers is a little different.
  void push(std::mt19937_64& random, double much) {
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (std::size_t j = 0; j < 6; ++j) own_.velocities[j] += much * any(random) * (j < 3 ? 30.0 : 1.0);
    VectorXd by(8);
    for (int j = 0; j < 8; ++j) by[j] = 0.1 * much * any(random);
    VectorXd::Map(&own_.velocities[6], kRows) += jacobian_ * by;
  }
  double miss() const { return own_.miss(); }  // m/s

 private:
  template <typename Some, typename Any>
  void add_contact(std::size_t k, Some& some, Any& any, std::mt19937_64& random) {
    const Corner corner(k);
    RowBlock block;
    block.kind = RowBlock::Kind::kContact;
    block.dim = 3;
    block.end_count = 2;
    block.friction = kGrip;
    block.give = kGive;
    block.free_response = 15.0;
    RowEnd &box = block.ends[0], &hand = block.ends[1];
    box.free = true;
    box.offset = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d turns = corner.point.cross(corner.axes[i]);
      for (int j = 0; j < 3; ++j) {
        box.J[i][static_cast<std::size_t>(j)] = turns[j];
        box.J[i][static_cast<std::size_t>(3 + j)] = corner.axes[i][j];
      }
    }
    rows_.respond(block, box, Matrix3d(Matrix3d::Identity() / 3e-4).data(), 1.0 / 0.5);
    hand.free = false;
    hand.offset = 6;
    hand.first = 3 * k;
    hand.size = kRows;
    hand.response = 0;
    // A start as a tick before may have left it: near the edge of the cone, the corners of a face against
    // each other.
    block.lambda[0] = 0.002 * some(random);
    const double outwards = corner.point.x() > 0.0 ? 1.0 : -1.0;
    block.lambda[1] = 0.8 * outwards * kGrip * block.lambda[0] * (0.6 + 0.4 * some(random));
    block.lambda[2] = 0.4 * kGrip * block.lambda[0] * any(random);
    own_.blocks.push_back(block);
  }

  OwnIsland own_;
  Rows rows_;
  MatrixXd response_, jacobian_;
};

struct Found {
  int missed = 0;      // of 9,000 solutions, by more than 1e-6 m/s
  double worst = 0.0;  // m/s
};

Found solve_many(int most_sweeps) {
  std::mt19937_64 random(1);
  Found found;
  for (int i = 0; i < 30; ++i) {
    Grasp grasp(random);
    for (int tick = 0; tick < 300; ++tick) {
      grasp.rows().solve(most_sweeps, 1e-11, 1e-7, 0.0);
      const double miss = grasp.miss();
      found.missed += miss > 1e-6;
      found.worst = std::max(found.worst, miss);
      grasp.push(random, 1e-3);
    }
  }
  return found;
}

// So many vehicles, each on two rows of driven wheels, as one mechanism each. Wheels push and brake against
// each other by turns, so that contacts slide and stick.
struct Fleet {
  int vehicles = 1, wheels = 4;
  bool backwards = false;       // blocks stand in the opposite order of the mechanism's rows
  int idle_rows = 0;            // more rows of a mechanism, of which no block speaks
  double wheel_inertia = 0.03;  // kg m²; a servo holds a wheel's speed as a large one does
};

class Vehicles {
 public:
  explicit Vehicles(const Fleet& fleet)
      : fleet_(fleet),
        jacobian_(MatrixXd::Zero(3 * fleet.wheels + fleet.idle_rows, 6 + fleet.wheels)),
        inverse_mass_(VectorXd::Constant(6 + fleet.wheels, 1.0 / fleet.wheel_inertia)),
        velocity_(MatrixXd::Zero(6 + fleet.wheels, fleet.vehicles)) {
    for (int k = 0; k < fleet.wheels; ++k) direct_wheel(k);
    jacobian_.bottomRows(fleet.idle_rows).setConstant(0.5);
    inverse_mass_.head<6>() << Vector3d(1.0 / 0.2, 1.0 / 0.4, 1.0 / 0.5), Vector3d::Constant(1.0 / 12.0);
    const MatrixXd response = jacobian_ * inverse_mass_.asDiagonal() * jacobian_.transpose();
    for (int vehicle = 0; vehicle < fleet.vehicles; ++vehicle) {
      own_.responses.insert(own_.responses.end(), response.data(), response.data() + response.size());
      for (int k = 0; k < fleet.wheels; ++k) add_wheel(vehicle, k);
    }
    if (fleet.backwards) std::ranges::reverse(own_.blocks);
    own_.velocities.resize(static_cast<std::size_t>(jacobian_.rows() * fleet.vehicles));
  }

  // Goes on by a millisecond under these accelerations of bodies (angular, linear) and wheels.
  void tick(const VectorXd& acceleration) {
    velocity_.colwise() += 1e-3 * acceleration;
    MatrixXd::Map(own_.velocities.data(), jacobian_.rows(), fleet_.vehicles) = jacobian_ * velocity_;
    for (RowBlock& block : own_.blocks) {
      block.K = {};
      block.applied = {};
    }
    work_.start(1'000'000'000);
    own_.prepare(rows_);
    own_.set_calm();
    own_.solve(rows_, 20);
    for (const RowBlock& block : own_.blocks)
      velocity_.col(static_cast<int>(block.ends[0].mechanism)) +=
          inverse_mass_.asDiagonal() *
          jacobian_.middleRows<3>(static_cast<int>(block.ends[0].first)).transpose() *
          Vector3d::Map(block.lambda.data());
  }
  void turn_wheel(int k, double speed) { velocity_.row(6 + k).setConstant(speed); }
  double miss() const { return own_.miss(); }           // m/s
  std::uint64_t work() const { return work_.taken(); }  // of the last tick
  int sliding() const {
    return static_cast<int>(std::ranges::count_if(own_.blocks, [](const RowBlock& block) {
      return std::hypot(block.lambda[1], block.lambda[2]) > 0.999999 * block.friction * block.lambda[0];
    }));
  }

 private:
  void direct_wheel(int k) {
    const Vector3d place(0.3 * (k / 2) / (fleet_.wheels / 2 - 1) - 0.15, k % 2 == 0 ? 0.2 : -0.2, -0.1);
    const std::array<Vector3d, 3> axes{Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0, 1, 0)};
    for (int i = 0; i < 3; ++i) {
      const Vector3d& along = axes[static_cast<std::size_t>(i)];
      jacobian_.block<1, 6>(3 * k + i, 0) << place.cross(along).transpose(), along.transpose();
    }
    jacobian_(3 * k + 1, 6 + k) = -0.08;  // the wheel's radius
  }

  void add_wheel(int vehicle, int k) {
    RowBlock block;
    block.kind = RowBlock::Kind::kContact;
    block.dim = 3;
    block.end_count = 1;
    block.friction = 0.9;
    block.give = kGive;
    block.free_response = 1.0;
    RowEnd& end = block.ends[0];
    end.free = false;
    end.mechanism = static_cast<std::size_t>(vehicle);
    end.first = static_cast<std::size_t>(3 * k);
    end.size = static_cast<std::size_t>(jacobian_.rows());
    end.offset = end.mechanism * end.size;
    end.response = end.offset * end.size;
    own_.blocks.push_back(block);
  }

  Fleet fleet_;
  OwnIsland own_;
  WorkBudget work_;
  Rows rows_{kernels(), &work_};
  MatrixXd jacobian_;
  VectorXd inverse_mass_;
  MatrixXd velocity_;  // of each vehicle
};

// Few rows have full matrices, many an envelope. What impulses do to each other is found in any arrangement.
TEST(MechanismRows, VehiclesAreSolvedOnFewAndOnManyWheels) {
  for (const Fleet& fleet : {Fleet{}, Fleet{.vehicles = 2}, Fleet{.backwards = true}, Fleet{.idle_rows = 1},
                             Fleet{.vehicles = 3, .backwards = true, .idle_rows = 2}, Fleet{.wheels = 40}}) {
    Vehicles vehicles(fleet);
    const int wheels = fleet.wheels * fleet.vehicles;
    const std::string name = std::to_string(wheels) + " wheels, " + std::to_string(fleet.idle_rows) +
                             (fleet.backwards ? " idle rows, backwards" : " idle rows");
    int sometimes = 0;  // some wheels slide, others do not
    double worst = 0.0;
    for (int i = 0; i < 2000; ++i) {
      VectorXd acceleration = VectorXd::Zero(6 + fleet.wheels);
      acceleration[2] = 6.0 * std::sin(0.017 * i);
      acceleration[4] = 5.0 * std::sin(0.01 * i);  // to the side, as in a bend
      acceleration[5] = -9.81;
      for (int k = 0; k < fleet.wheels; ++k) acceleration[6 + k] = 100.0 * std::sin((0.021 + 3e-4 * k) * i);
      vehicles.tick(acceleration);
      sometimes += vehicles.sliding() > 0 && vehicles.sliding() < wheels;
      worst = std::max(worst, vehicles.miss());
    }
    EXPECT_GT(sometimes, 100) << name;
    EXPECT_LT(worst, 1e-7) << name;
  }
}

// In a wide bend, wheels whose speeds are held creep by less than a millimetre per second, and all slide.
// A little shaking makes the row of one wheel or another say that it sticks. If it stuck in Newton's first
// pass, more passes would have to follow.
TEST(MechanismRows, CreepingWheelsSlideOn) {
  constexpr std::uint64_t kMostWork = 600;  // they take at most 445; without that 876, and 602 in the mean
  constexpr Fleet kFleet{.wheel_inertia = 1000.0};
  Vehicles vehicle(kFleet);
  for (int k = 0; k < kFleet.wheels; ++k) vehicle.turn_wheel(k, k % 2 == 0 ? 1.0 : 1.01);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(-0.5, 0.5);
  for (int i = 0; i < 2000; ++i) {
    VectorXd acceleration = VectorXd::Zero(6 + kFleet.wheels);
    for (int j = 0; j < 5; ++j) acceleration[j] = any(random);
    acceleration[5] = -9.81;
    vehicle.tick(acceleration);
    if (i < 100) continue;  // it starts from rest
    ASSERT_EQ(vehicle.sliding(), kFleet.wheels) << "tick " << i;
    ASSERT_LT(vehicle.work(), kMostWork) << "tick " << i;
    ASSERT_LT(vehicle.miss(), 1e-9) << "tick " << i;
  }
}

TEST(MechanismRows, AGraspIsSolved) {
  const Found found = solve_many(200);
  EXPECT_EQ(found.missed, 0) << "the worst by " << found.worst << " m/s";
}

// Impulses that balance each other must not be cut off singly: that would leave 0.017 m/s.
TEST(MechanismRows, WhatIsSolvedAtOnceTakesNoGraspApart) {
  EXPECT_LT(solve_many(0).worst, 5e-4);
}

}  // namespace
}  // namespace visum::dynamics::impulse
