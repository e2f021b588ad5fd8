// A body on a thin plate is pushed up wherever it stands, at the rim and at the corners, too. These pairs go
// through GJK, whose cores must not be smaller than the plate by more than their skins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/collision/scene.h"

namespace visum::collision::testing {
namespace {

using enum ShapeKind;
constexpr double kPressedM = 1e-4;
constexpr double kPlateHalfM = 0.01;

// The corners of an upright prism. Its hull has more directions than are tested one by one.
std::vector<Eigen::Vector3d> prism_points(double radius, double length) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 32; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 32;
    for (const double side : {-0.5, 0.5})
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), side * length);
  }
  return points;
}

struct OnPlate {
  const char* name;
  ShapeSpec upper;  // of kConvex: a prism, size as a cylinder's
  double half_height;
  ShapeSpec plate;
  double reach;  // from the plate's middle; places farther out are not tested

  friend void PrintTo(const OnPlate& test, std::ostream* out) { *out << test.name; }
};

void add_solid(SceneBuilder& scene, const ShapeSpec& spec, const Pose& pose) {
  scene.add(spec, pose);
  if (spec.kind == kConvex) scene.model.meshes.back().vertices = prism_points(spec.size[0], spec.size[1]);
}

class ThinPlates : public ::testing::TestWithParam<OnPlate> {};

TEST_P(ThinPlates, PushUpWhatStandsOnThemAnywhere) {
  const OnPlate& test = GetParam();
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; j <= 40; j += 4) {
      const double x = 0.013 * i, y = 0.0129 * j;
      const double outside = test.plate.kind == kBox
                                 ? std::hypot(std::max(x - 0.5, 0.0), std::max(y - 0.5, 0.0))
                                 : std::max(std::hypot(x, y) - 0.495, 0.0);
      if (outside > test.reach) continue;
      SceneBuilder scene;
      add_solid(scene, test.upper, at(x, y, kPlateHalfM + test.half_height - kPressedM));
      add_solid(scene, test.plate, {});
      double deepest = 0.0;
      for (const Contact& contact : contacts_of(scene.model)) {
        EXPECT_NEAR(contact.normal_W.z(), 1.0, 1e-9) << "at " << x << ", " << y;
        deepest = std::max(deepest, contact.depth);
      }
      EXPECT_NEAR(deepest, kPressedM, 1e-6) << "at " << x << ", " << y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Pairs, ThinPlates,
    ::testing::Values(
        OnPlate{"CanOnBox", {kCylinder, {0.02, 0.1}}, 0.05, {kBox, {1, 1, 2 * kPlateHalfM}}, 0.015},
        OnPlate{"PrismOnBox", {kConvex, {0.02, 0.1}}, 0.05, {kBox, {1, 1, 2 * kPlateHalfM}}, 0.015},
        OnPlate{"BoxOnDisc", {kBox, {0.04, 0.04, 0.04}}, 0.02, {kConvex, {0.5, 2 * kPlateHalfM}}, 0.012},
        OnPlate{"CanOnDisc", {kCylinder, {0.02, 0.1}}, 0.05, {kConvex, {0.5, 2 * kPlateHalfM}}, 0.012}),
    [](const auto& info) { return std::string(info.param.name); });

// A lens tapers off to a thin, flat rim. The core of even a true inset ends far from it.
TEST(ThinLens, PushesUpWhatStandsOnItsRim) {
  constexpr double kSlope = 0.02, kRimM = 0.001;
  for (double x = 0.0; x < 0.51; x += 0.01) {
    SceneBuilder scene;
    const double highest = 0.5 * kRimM + kSlope * (0.5 - std::max(x - 0.02, 0.0));  // below the can
    scene.add({kCylinder, {0.02, 0.1}}, at(x, 0, highest + 0.05 - kPressedM));
    scene.add({kConvex, {1, 1, 1}}, {});
    auto& points = scene.model.meshes.back().vertices;
    points = prism_points(0.5, kRimM);
    for (const double side : {-1.0, 1.0}) points.emplace_back(0, 0, side * (0.5 * kRimM + kSlope * 0.5));
    const auto contacts = contacts_of(scene.model);
    ASSERT_FALSE(contacts.empty()) << "at " << x;
    for (const Contact& contact : contacts) {
      EXPECT_GT(contact.normal_W.z(), 0.99) << "at " << x;
      EXPECT_LT(contact.depth, 1.1 * kPressedM) << "at " << x;
    }
  }
}

}  // namespace
}  // namespace visum::collision::testing
