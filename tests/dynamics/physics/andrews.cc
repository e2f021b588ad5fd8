#include "tests/dynamics/physics/andrews.h"

#include <cmath>

#include "tests/dynamics/physics/measures.h"

namespace visum::physics {
namespace {

using dynamics::testing::at;
using dynamics::testing::ModelBuilder;
using Eigen::Vector3d;
using world::BodyId;

// Lengths in m, in the letters of the sources.
constexpr double kD = 0.028, kDa = 0.0115, kE = 0.02, kEa = 0.01421, kRr = 0.007, kRa = 0.00092, kSs = 0.035,
                 kSa = 0.01874, kSb = 0.01043, kSc = 0.018, kSd = 0.02, kTa = 0.02308, kTb = 0.00916,
                 kU = 0.04, kUa = 0.01228, kUb = 0.00449, kZf = 0.02, kZt = 0.04, kFa = 0.01421;
constexpr double kStiffness = 4530.0, kRest = 0.07785;
constexpr double kBeta = -0.0617138900142764, kTheta = 0.0, kGamma = 0.4552798191630704,
                 kPhi = 0.2226683901658859, kDelta = 0.4873649795438426, kOmega = -0.2226683901658859,
                 kEpsilon = 1.2305474445498212;
const Vector3d kA{-0.06934, -0.00227, 0.0}, kB{-0.03635, 0.03273, 0.0}, kC{0.014, 0.072, 0.0};

// (cos a, sin a) and (sin a, -cos a).
Vector3d along(double a) {
  return {std::cos(a), std::sin(a), 0.0};
}
Vector3d below(double a) {
  return {std::sin(a), -std::cos(a), 0.0};
}

struct Bodies {
  BodyId k1, k2, k3, k4, k5, k6, k7;
};

// The bodies with their centres of mass where they start.
Bodies add_bodies(ModelBuilder& b) {
  const auto add = [&](const char* name, double mass_kg, double inertia, const Vector3d& p) {
    return b.add_rotor(name, mass_kg, inertia, at(p.x(), p.y(), p.z()));
  };
  return {add("k1", 0.04325, 2.194e-6, kRa * along(kBeta)),
          add("k2", 0.00365, 4.410e-7, kRr * along(kBeta) - kDa * along(kBeta + kTheta)),
          add("k3", 0.02373, 5.255e-6, kB + kSa * below(kGamma) + kSb * along(kGamma)),
          add("k4", 0.00706, 5.667e-7, kA + kZt * along(kDelta) + (kE - kEa) * below(kPhi + kDelta)),
          add("k5", 0.07050, 1.169e-5, kA + kTa * along(kDelta) - kTb * below(kDelta)),
          add("k6", 0.00706, 5.667e-7, kA + kU * below(kEpsilon) + (kZf - kFa) * along(kOmega + kEpsilon)),
          add("k7", 0.05498, 1.912e-5, kA + kUa * below(kEpsilon) - kUb * along(kEpsilon))};
}

void add_spring(ModelBuilder& b, BodyId k3) {
  world::Joint spring;
  spring.name = "spring";
  spring.kind = world::JointKind::kSpring;
  spring.child = k3;
  spring.X_PJ.p = kC;
  spring.X_CJ.p = b.body(k3).X_WB.inverse() * Vector3d(kB + kSc * below(kGamma) + kSd * along(kGamma));
  spring.stiffness = kStiffness;
  spring.rest = kRest;
  b.model.joints.push_back(spring);
}

}  // namespace

world::WorldModel andrews(const world::EngineSetting& engine, double tick_s) {
  ModelBuilder b(engine);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  b.model.gravity.setZero();
  const Bodies k = add_bodies(b);
  const Vector3d end = kRr * along(kBeta), meeting = end - kD * along(kBeta + kTheta);
  const auto hinge = [&](const char* name, BodyId parent, BodyId child, const Vector3d& p) {
    b.add_joint(name, world::JointKind::kHinge, parent, child, p, Vector3d::UnitZ());
  };
  hinge("crank", {}, k.k1, Vector3d::Zero());
  hinge("rod", k.k1, k.k2, end);
  hinge("triangle", {}, k.k3, kB);
  hinge("upper_arm", {}, k.k5, kA);
  hinge("upper_link", k.k5, k.k4, kA + kZt * along(kDelta));
  hinge("lower_arm", {}, k.k7, kA);
  hinge("lower_link", k.k7, k.k6, kA + kU * below(kEpsilon));
  hinge("close_triangle", k.k2, k.k3, meeting);
  hinge("close_upper", k.k2, k.k4, meeting);
  hinge("close_lower", k.k2, k.k6, meeting);
  add_spring(b, k.k3);
  return b.model;
}

const std::vector<AndrewsPoint>& andrews_points() {
  static const std::vector<AndrewsPoint> points{{0.01, {-0.003890552, 0.005819244, 0.0}},
                                                {0.02, {-0.002274421, 0.006620197, 0.0}},
                                                {0.03, {-0.006963039, -0.000718388, 0.0}},
                                                {0.04, {0.005086199, -0.004809426, 0.0}},
                                                {0.05, {-0.005208505, 0.004676695, 0.0}}};
  return points;
}

Vector3d andrews_f(const world::WorldModel& model, const world::WorldState& state) {
  return point_of(model, state, {0}, (kRr - kRa) * along(kBeta));
}

double andrews_beta(const world::WorldState& state) {
  return kBeta + state.joints[0].position;
}

}  // namespace visum::physics
