// Inverse kinematics of three arms (arms.json): a pose that comes from joint values within the limits is
// found again, and one out of reach is told.
#include "clients/cpp/kinematics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>

#include "clients/cpp/visum.h"
#include "protocol/config/config.h"

namespace visum {
namespace {

constexpr int kPoses = 10'000;  // of each arm

// The generator of Park and Miller, as in the tests of the page and of the Python client.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : seed_(seed) {}
  double next() {
    seed_ = 48271 * seed_ % 2147483647;
    return static_cast<double>(seed_) / 2147483647.0;
  }
  std::vector<double> within(const Chain& chain) {
    std::vector<double> values;
    for (const auto& joint : chain.joints())
      values.push_back(joint.lower + next() * (joint.upper - joint.lower));
    return values;
  }

 private:
  std::uint64_t seed_;
};

Chain arm(const std::string& name) {
  const auto file = std::filesystem::path(VISUM_SOURCE_DIR) / "tests/clients/arms.json";
  const auto list = config::load_file(file).get(name);
  std::vector<ChainJoint> joints;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto node = list.at(i);
    const auto frame = node.get("frame").numbers(7), axis = node.get("axis").numbers(3);
    ChainJoint joint;
    joint.name = node.get("name").text();
    joint.slides = node.get("slides").boolean();
    joint.frame = {{frame[0], frame[1], frame[2]}, {frame[3], frame[4], frame[5], frame[6]}};
    std::copy_n(axis.begin(), 3, joint.axis.begin());
    joint.lower = node.get("lower").number();
    joint.upper = node.get("upper").number();
    joints.push_back(joint);
  }
  return Chain("", std::move(joints));
}

// The largest difference of two poses' numbers; q and -q are the same orientation.
double apart(const Pose& a, const Pose& b) {
  double most = 0.0, dot = 0.0;
  for (std::size_t i = 0; i < 3; ++i) most = std::max(most, std::abs(a.position[i] - b.position[i]));
  for (std::size_t i = 0; i < 4; ++i) dot += a.orientation[i] * b.orientation[i];
  for (std::size_t i = 0; i < 4; ++i)
    most = std::max(most, std::abs(a.orientation[i] - (dot < 0.0 ? -1.0 : 1.0) * b.orientation[i]));
  return most;
}

class Inverse : public testing::TestWithParam<const char*> {};

TEST_P(Inverse, FindsEveryPoseThatCanBeReachedWithinTheLimits) {
  const Chain chain = arm(GetParam());
  Numbers numbers(7);
  for (int i = 0; i < kPoses; ++i) {
    const Pose tool = chain.forward(numbers.within(chain));
    const auto found = chain.inverse(tool, numbers.within(chain));
    ASSERT_TRUE(found.reached) << "pose " << i << ": " << found.position_error << " m";
    ASSERT_LT(apart(chain.forward(found.values), tool), 2e-6) << "pose " << i;
    for (std::size_t j = 0; j < chain.size(); ++j) {
      ASSERT_GE(found.values[j], chain.joints()[j].lower);
      ASSERT_LE(found.values[j], chain.joints()[j].upper);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, Inverse, testing::Values("amtec_arm", "six_turning", "cylindrical"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Kinematics, TellsAPoseOutOfReach) {
  const Chain chain = arm("amtec_arm");
  const auto found = chain.inverse({{5.0, 0.0, 0.5}, {1.0, 0.0, 0.0, 0.0}},
                                   std::vector<double>(chain.size(), 0.1), {.starts = 1});
  EXPECT_FALSE(found.reached);
  EXPECT_GT(found.position_error, 3.5);
  for (const double value : found.values) EXPECT_TRUE(std::isfinite(value));
}

TEST(Kinematics, RefusesAVectorOfTheWrongLength) {
  EXPECT_THROW(arm("amtec_arm").forward(std::vector{0.0, 0.0}), Error);
}

TEST(Kinematics, APoseAndItsInverseCancel) {
  const Chain chain = arm("cylindrical");
  const Pose pose = chain.forward(Numbers(3).within(chain));
  EXPECT_LT(apart(compose(pose, inverse_of(pose)), {}), 1e-12);
}

}  // namespace
}  // namespace visum
