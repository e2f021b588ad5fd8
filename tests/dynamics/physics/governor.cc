#include <cmath>
#include <numbers>
#include <string>

#include "tests/dynamics/model_builder.h"
#include "tests/dynamics/physics/loop_models.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;
using world::BodyId;

constexpr double kDensity = 3000.0, kWidth = 0.01, kRodKg = kDensity * kWidth * kWidth, kBallKg = 5.0;
constexpr double kMiddle = 0.5;  // m along a rod: where its coupler holds it, and the couplers' length
constexpr double kShaftStiffness = 8e5, kDamping = 4e4;
constexpr double kSpin = 2.0 * std::numbers::pi;
const Vector3d kUp = Vector3d::UnitZ();

// A rod of 1 m along its z from its upper end, the ball a point at the lower one.
BodyId add_armed_rod(ModelBuilder& b, const std::string& name, double angle) {
  constexpr double kMass = kRodKg + kBallKg, kCentre = (0.5 * kRodKg + kBallKg) / kMass;
  const Vector3d down = Eigen::AngleAxisd(angle, Vector3d::UnitY()) * -kUp;
  const Vector3d centre = kCentre * down;
  const BodyId rod =
      b.add_rotor(name, kMass, 1.0, at(centre.x(), centre.y(), centre.z(), angle, Vector3d::UnitY()));
  const double across = kRodKg * (1.0 + kWidth * kWidth) / 12.0 + kRodKg * (kCentre - 0.5) * (kCentre - 0.5) +
                        kBallKg * (1.0 - kCentre) * (1.0 - kCentre);
  b.body(rod).inertia_C = Vector3d(across, across, kRodKg * kWidth * kWidth / 6.0).asDiagonal();
  b.body(rod).w_WB = kSpin * kUp;
  b.body(rod).v_WB = kSpin * kUp.cross(centre);
  return rod;
}

void add_coupler(ModelBuilder& b, const std::string& name, BodyId slider, BodyId rod, const Vector3d& p_W) {
  world::Joint spring;
  spring.name = name;
  spring.kind = world::JointKind::kSpring;
  spring.parent = slider;
  spring.child = rod;
  spring.X_CJ.p = b.body(rod).X_WB.inverse() * p_W;
  spring.stiffness = kShaftStiffness;
  spring.damping = kDamping;
  spring.rest = kMiddle;
  b.model.joints.push_back(spring);
}

}  // namespace

world::WorldModel governor(const world::EngineSetting& engine, double tick_s) {
  constexpr double kStart = std::numbers::pi / 6.0, kCube = 0.1, kCubeKg = kDensity * kCube * kCube * kCube;
  ModelBuilder b(engine);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  const BodyId shaft = b.add_rotor("shaft", kRodKg, kRodKg * kWidth * kWidth / 6.0, at(0.0, 0.0, -0.5));
  const BodyId slider = b.add_rotor("slider", kCubeKg, kCubeKg * kCube * kCube / 6.0,
                                    at(0.0, 0.0, -2.0 * kMiddle * std::cos(kStart)));
  for (const BodyId id : {shaft, slider}) b.body(id).w_WB = kSpin * kUp;
  b.add_joint("bearing", world::JointKind::kHinge, {}, shaft, Vector3d::Zero(), kUp);
  b.add_joint("slide", world::JointKind::kSlider, shaft, slider, b.body(slider).X_WB.p, -kUp);
  for (const double side : {-1.0, 1.0}) {
    const std::string name = side < 0.0 ? "right" : "left";
    const BodyId rod = add_armed_rod(b, name, side * kStart);
    const Vector3d middle = Eigen::AngleAxisd(side * kStart, Vector3d::UnitY()) * (-kMiddle * kUp);
    b.add_joint(name + "_hinge", world::JointKind::kHinge, shaft, rod, Vector3d::Zero(),
                side * Vector3d::UnitY());
    add_coupler(b, name + "_coupler", slider, rod, middle);
  }
  return b.model;
}

// By RK4 in long double with steps of 5 and 2.5 us, which agree to 1e-15.
const std::vector<GovernorAt>& governor_poses() {
  static const std::vector<GovernorAt> poses{
      {0.1, 0.569419013144680, 0.842246234885746}, {0.5, 0.869353750213359, 0.645347113972479},
      {1.0, 0.524470297241188, 0.865625539430827}, {2.0, 0.527053273013356, 0.864329427860060},
      {5.0, 0.544489014105266, 0.855428920191702}, {10.0, 0.598952254516341, 0.825963441503513}};
  return poses;
}

}  // namespace visum::physics
