// A hull's bits decide those of contacts, and so the state hash of a scene. They hold the order in which the
// algorithm takes points and faces, and that of its operations: another order gives an equally good hull, but
// recordings no longer replay. A hash that changes needs a line in the changelog that says why.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "server/collision/hull.h"

namespace visum::collision::testing {
namespace {

using Points = std::vector<Eigen::Vector3d>;

// Only operations that have one result everywhere, unlike the distributions and the sine of a library.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double within(double most) { return most * (static_cast<double>(engine_()) / 2147483648.0 - 1.0); }

 private:
  std::mt19937 engine_;
};

std::uint64_t hash_of_hull(const Points& points) {
  const Polytope hull = make_hull(points);
  XXH3_state_t* const state = XXH3_createState();
  XXH3_64bits_reset(state);
  const auto add = [&](const auto& list) {
    XXH3_64bits_update(state, list.data(), list.size() * sizeof list[0]);
  };
  static_assert(sizeof(Polytope::Face) == 32, "no unused bytes");
  add(hull.vertices);
  add(hull.faces);
  add(hull.corners);
  add(hull.normals);
  add(hull.edges);
  for (const auto& faces : hull.faces_of) add(faces);
  const std::uint64_t hash = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return hash;
}

// On each face a grid of points that are a little off, less than faces of one polygon may be.
Points cube_with_noise(double noise) {
  Random random(1);
  Points points;
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j)
      for (int k = -3; k <= 3; ++k) {
        const double x = random.within(noise), y = random.within(noise), z = random.within(noise);
        points.emplace_back(i / 3.0 + x, j / 3.0 + y, k / 3.0 + z);
      }
  return points;
}

Points sphere(int count) {
  Random random(2);
  Points points;
  while (points.size() < static_cast<std::size_t>(count)) {
    const double x = random.within(1.0), y = random.within(1.0), z = random.within(1.0);
    const double length = std::sqrt(x * x + y * y + z * z);
    if (length > 0.1 && length < 1.0) points.emplace_back(x / length, y / length, z / length);
  }
  return points;
}

Points nearly_flat_plate() {
  Random random(3);
  Points points;
  for (int i = 0; i < 500; ++i) {
    const double x = random.within(1.0), y = random.within(0.7), z = random.within(1e-5);
    points.emplace_back(x, y, z);
  }
  return points;
}

// A turned disc whose coordinates are rounded, as those in files are.
Points rounded_disc(int sides) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2 + 0.01 * sides).normalized();
  Points points;
  for (int i = 0; i < sides; ++i) {
    const double t = 4.0 * (7 * i % sides) / sides - 2.0, s = 1.0 + t * t;
    for (const double z : {-0.02, 0.02})
      points.push_back(
          (turn * Eigen::Vector3d((1.0 - t * t) / s, 2.0 * t / s, z)).cast<float>().cast<double>());
  }
  return points;
}

TEST(HullBits, OfACubeWithNoise) {
  EXPECT_EQ(hash_of_hull(cube_with_noise(1e-6)), 5607742554923365233u);
  EXPECT_EQ(hash_of_hull(cube_with_noise(0.01)), 813299331351442947u);
}

TEST(HullBits, OfASphere) {
  EXPECT_EQ(hash_of_hull(sphere(4000)), 5684795095107275526u);
}

TEST(HullBits, OfANearlyFlatPlate) {
  EXPECT_EQ(hash_of_hull(nearly_flat_plate()), 15464904894299096959u);
}

// The first algorithm, which rounds, finds no hull of these points. The exact one does.
TEST(HullBits, OfPointsThatNeedTheExactHull) {
  EXPECT_EQ(hash_of_hull(rounded_disc(150)), 5382654473040659650u);
}

}  // namespace
}  // namespace visum::collision::testing
