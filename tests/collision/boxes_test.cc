// Boxes have a test of separating axes of their own (boxes.h). It must find what the hull of the same corners
// finds.
#include <gtest/gtest.h>

#include <random>

#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;

class RandomPoses {
 public:
  Pose next() {
    const Eigen::Vector3d axis(uniform_(generator_), uniform_(generator_), uniform_(generator_));
    return at(0.8 * uniform_(generator_), 0.8 * uniform_(generator_), 0.8 * uniform_(generator_),
              3.0 * uniform_(generator_), axis.normalized());
  }

 private:
  std::mt19937 generator_{42};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

TEST(Boxes, TouchAsHullsOfTheSameCornersDo) {
  const std::array<double, 3> size_a{1.0, 0.6, 0.4}, size_b{0.5, 0.7, 0.9};
  RandomPoses poses;
  int touching = 0;
  for (int i = 0; i < 500; ++i) {
    const Pose a = poses.next(), b = poses.next();
    const auto boxes = contacts_between({kBox, size_a}, a, {kBox, size_b}, b);
    const auto hulls = contacts_between({kConvex, size_a}, a, {kConvex, size_b}, b);
    ASSERT_EQ(boxes.empty(), hulls.empty()) << i;
    if (boxes.empty()) continue;
    ++touching;
    EXPECT_LT((boxes[0].normal_W - hulls[0].normal_W).norm(), 1e-9) << i;
    EXPECT_EQ(boxes.size(), hulls.size()) << i;
    const auto deeper = [](const Contact& x, const Contact& y) { return x.depth < y.depth; };
    EXPECT_NEAR(std::max_element(boxes.begin(), boxes.end(), deeper)->depth,
                std::max_element(hulls.begin(), hulls.end(), deeper)->depth, 1e-9)
        << i;
  }
  EXPECT_GT(touching, 100);
  EXPECT_LT(touching, 450);
}

// Their edges lie on each other, so the point where they cross may be anywhere.
TEST(Boxes, OfOneSizeOnEachOtherTouchInTheirFourCorners) {
  const ShapeSpec box{kBox, {0.2, 0.2, 0.2}};
  for (const double off : {0.0, 1e-12, 1e-9, 1e-7, 5e-7}) {
    for (const double turn : {-off, off, 3.0 * off}) {
      const auto contacts =
          contacts_between(box, at(off, -off, 0.2 - 1e-6, turn, Eigen::Vector3d::UnitZ()), box, {});
      ASSERT_EQ(contacts.size(), 4u) << off << ' ' << turn;
      for (const Contact& contact : contacts) {
        EXPECT_NEAR(std::abs(contact.p_W.x()), 0.1, 2e-6);
        EXPECT_NEAR(std::abs(contact.p_W.y()), 0.1, 2e-6);
        EXPECT_NEAR(contact.depth, 1e-6, 1e-9);
      }
    }
  }
}

// Rounding must not choose between the two faces from tick to tick: they differ in corners and normals.
TEST(Boxes, OfOneSizeKeepTheCornersAndTheNormalOfTheFirst) {
  const ShapeSpec box{kBox, {0.2, 0.2, 0.2}};
  const Eigen::Vector3d sideways(3e-7, -2e-7, 0.0);
  for (const double tilt : {-1e-9, -1e-12, 0.0, 1e-12, 1e-9}) {
    Pose above = at(0.0, 0.0, 0.2 - 1e-6, tilt, Eigen::Vector3d::UnitX());
    above.p += sideways;
    const auto contacts = contacts_between(box, above, box, {});
    ASSERT_EQ(contacts.size(), 4u) << tilt;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Contact& contact : contacts) middle += 0.25 * contact.p_W;
    EXPECT_LT((middle - sideways - Eigen::Vector3d(0.0, 0.0, 0.1 - 5e-7)).norm(), 1e-9) << tilt;
    for (const Contact& contact : contacts) EXPECT_EQ(contact.normal_W, contacts[0].normal_W) << tilt;
    EXPECT_LT((contacts[0].normal_W - above.q * Eigen::Vector3d::UnitZ()).norm(), 1e-15) << tilt;
  }
}

}  // namespace
}  // namespace visum::collision::testing
