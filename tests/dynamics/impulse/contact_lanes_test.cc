// Contacts side by side miss what each of them misses alone, to the last bit.
#include "server/dynamics/impulse/contact_lanes.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {
namespace {

constexpr std::size_t kSceneBodies = 5, kSceneContacts = 7;  // so that one lane is left over

// Contacts between the bodies, and with the ground, in any state: open, sticking, sliding, without friction,
// held fast. One row with two bounds stands among them.
class ContactScene {
 public:
  ContactScene(std::uint64_t seed, const Kernels& by) : rows_(by), random_(seed) {
    for (std::size_t k = 0; k < 6 * kSceneBodies; ++k) velocities_.push_back(any());
    for (std::size_t i = 0; i < kSceneBodies; ++i)
      bodies_.push_back({1.0, {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}});
    for (std::size_t i = 0; i < kSceneContacts; ++i) {
      if (i == 2) add_bounded();
      add_contact(i);
    }
    island_ = {blocks_, velocities_, bodies_, {}};
    rows_.prepare(island_);
    for (RowBlock& block : blocks_)
      for (std::size_t i = 0; i < block.dim; ++i) block.centre[i] = 0.1 * any();
    lanes_ = ContactLanes(by);
    lanes_.lay_out(blocks_);
    lanes_.take_settings(blocks_);
  }

  void move() {
    for (double& velocity : velocities_) velocity += 0.1 * any();
    for (RowBlock& block : blocks_)
      for (double& impulse : block.lambda) impulse += 0.1 * any();
  }

  // One row misses this by its equation.
  double error(const RowBlock& block, std::size_t row) const {
    const double soft = block.softness[row] * (block.lambda[row] - block.centre[row]);
    const double error = block.target[row] - rows_.velocity(block, row) - soft;
    return row == 0 ? error - block.compliance * block.lambda[0] : error;
  }
  // The miss of one contact that fills all lanes.
  double miss_of(std::size_t block) {
    ContactLanes alone = lanes_;
    std::array<std::array<double, 3>, 1> errors;
    alone.lay_out({&blocks_[block], 1});
    alone.take_settings({&blocks_[block], 1});
    alone.find_errors({&blocks_[block], 1}, velocities_.data(), errors);
    return alone.largest_miss();
  }
  const std::vector<RowBlock>& blocks() const { return blocks_; }
  const Rows& rows() const { return rows_; }
  ContactLanes& lanes() { return lanes_; }
  std::vector<std::array<double, 3>> find_errors() {
    std::vector<std::array<double, 3>> errors(blocks_.size());
    lanes_.find_errors(blocks_, velocities_.data(), errors);
    return errors;
  }

 private:
  double any() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }

  void direct(RowBlock& block, std::size_t end, std::size_t body) {
    RowEnd& to = block.ends[end];
    to.offset = 6 * body;
    for (std::size_t i = 0; i < block.dim; ++i)
      for (double& entry : to.J[i]) entry = any();
    rows_.respond(block, to, Eigen::Matrix3d(Eigen::Matrix3d::Identity()).data(), 1.0);
  }

  void add_contact(std::size_t i) {
    RowBlock block;
    block.kind = RowBlock::Kind::kContact;
    block.dim = 3;
    block.end_count = i % 3 == 0 ? 1 : 2;
    for (std::size_t e = 0; e < block.end_count; ++e) direct(block, e, (i + e) % kSceneBodies);
    block.friction = i == 4 ? 0.0 : 0.5 + 0.4 * any();
    block.free_response = i == 5 ? 1e12 : 1.0;  // such a contact cannot be moved
    block.compliance = i == 6 ? 0.3 : 0.0;
    block.low = i == 1 ? -0.2 : 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      block.target[k] = any();
      block.base[k] = i == 3 ? 0.1 * any() : 0.0;
    }
    const double pressing = std::max(0.0, any());
    block.lambda = {pressing, 0.7 * pressing * any(), 0.7 * pressing * any()};
    blocks_.push_back(block);
  }

  void add_bounded() {
    RowBlock block;
    block.end_count = 1;
    block.high = 1.0;
    direct(block, 0, 0);
    blocks_.push_back(block);
  }

  Rows rows_;
  std::mt19937_64 random_;
  std::vector<RowBlock> blocks_;
  std::vector<double> velocities_;
  std::vector<FreeBody> bodies_;
  RowIsland island_;
  ContactLanes lanes_;
};

void expect_the_same_as_alone(const Kernels& by) {
  int sliding = 0, open = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    ContactScene scene(seed, by);
    for (int pass = 0; pass < 3; ++pass, scene.move()) {
      const auto errors = scene.find_errors();
      double largest = 0.0;
      for (std::size_t i = 0; i < scene.blocks().size(); ++i) {
        const RowBlock& block = scene.blocks()[i];
        if (block.kind != RowBlock::Kind::kContact) continue;
        for (std::size_t row = 0; row < 3; ++row)
          ASSERT_EQ(errors[i][row], scene.error(block, row))
              << by.build << ", seed " << seed << ", block " << i;
        ASSERT_EQ(scene.miss_of(i), scene.rows().miss(block))
            << by.build << ", seed " << seed << ", block " << i;
        largest = std::max(largest, scene.rows().miss(block));
        open += !(block.lambda[0] + errors[i][0] / stiffness_of(block) > block.low);
        sliding += std::hypot(block.lambda[1], block.lambda[2]) > block.friction * block.lambda[0];
      }
      ASSERT_EQ(scene.lanes().largest_miss(), largest) << by.build << ", seed " << seed;
    }
  }
  EXPECT_GT(open, 100);
  EXPECT_GT(sliding, 100);
}

TEST(ContactLanes, MissWhatEachContactMissesAlone) {
  expect_the_same_as_alone(kBaselineKernels);
  if (kWideKernels != nullptr && __builtin_cpu_supports("avx2")) expect_the_same_as_alone(*kWideKernels);
}

TEST(ContactLanes, LeaveOutWhatIsNoContact) {
  ContactScene scene(1, kernels());
  ASSERT_EQ(scene.lanes().others().size(), 1u);
  EXPECT_EQ(scene.blocks()[scene.lanes().others()[0]].kind, RowBlock::Kind::kBounded);
}

}  // namespace
}  // namespace visum::dynamics::impulse
