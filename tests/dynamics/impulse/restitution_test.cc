// The meaning of restitution where normal and tangent act on each other: T. R. Kane's rod, which hits a plane
// with one end (Kane, Levinson, Dynamics: Theory and Applications, 1985: with Newton's law it gains energy).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/model_builder.h"
#include "tests/dynamics/physics/engine_rows.h"

namespace visum::dynamics::impulse {
namespace {

using dynamics::testing::at;
using dynamics::testing::Lab;
using dynamics::testing::ModelBuilder;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Hit {
  double friction, restitution;
  double along;  // speed of the rod's centre along the plane, m/s; it falls with 1 m/s
  double slope = 0.25 * std::numbers::pi;

  friend void PrintTo(const Hit& hit, std::ostream* out) {
    *out << "friction " << hit.friction << ", restitution " << hit.restitution << ", " << hit.along
         << " m/s, " << hit.slope << " rad";
  }
};

// 1 kg, 1 m, a small ball at its lower end; touches the plane by 0.1 µm.
struct Rod {
  static constexpr double kInertia = 1.0 / 12.0, kBall = 0.01;

  Rod(const std::string& impact, const Hit& hit) : lab(model(impact, hit)) {}

  static world::WorldModel model(const std::string& impact, const Hit& hit) {
    auto setting = physics::engine_row("impulse").setting;
    setting.impact = impact;
    ModelBuilder b(setting);
    b.model.gravity.setZero();
    const auto surface = b.add_surface(hit.friction, hit.restitution);
    b.add_ground(surface);
    const Vector3d end = 0.5 * Vector3d(std::cos(hit.slope), 0.0, -std::sin(hit.slope));
    const auto rod = b.add_rotor("rod", 1.0, kInertia, at(0.0, 0.0, kBall - end.z() - 1e-7));
    b.body(rod).v_WB = {hit.along, 0.0, -1.0};
    world::Shape ball;
    ball.name = "ball";
    ball.body = rod;
    ball.kind = world::ShapeKind::kSphere;
    ball.size = {kBall};
    ball.X_BS.p = end;
    ball.surface = surface;
    b.model.shapes.push_back(ball);
    return b.model;
  }

  // (normal, tangential) velocity of the end, and its answer to impulses there.
  void meet() {
    before = {-1.0, lab.body("rod").v_WC.x()};
    energy_before = lab.kinetic_energy();
    const Vector3d centre = lab.body("rod").p_WC;
    EXPECT_TRUE(lab.step().ok);
    ASSERT_EQ(lab.contacts.size(), 1u);
    const Vector3d r = lab.contacts[0].p_W - centre;
    const Vector2d turns(-r.x(), r.z());
    response = Matrix2d::Identity() + turns * turns.transpose() / kInertia;
    const auto& motion = lab.body("rod");
    after = {motion.v_WC.z() - motion.w_WB.y() * r.x(), motion.v_WC.x() + motion.w_WB.y() * r.z()};
    energy_after = lab.kinetic_energy();
  }

  Lab lab;
  Vector2d before, after;
  Matrix2d response;
  double energy_before = 0.0, energy_after = 0.0;
};

double sticking(const Rod& rod, double normal, double friction) {
  const double held = -(rod.before[1] + rod.response(0, 1) * normal) / rod.response(1, 1);
  return std::clamp(held, -friction * normal, friction * normal);
}

// The impulse after which the end leaves with `speed`, and sticks or slides.
Vector2d impulse_for(const Rod& rod, double speed, double friction) {
  const Vector2d change(speed - rod.before[0], -rod.before[1]);
  const Vector2d sticks = rod.response.inverse() * change;
  if (std::abs(sticks[1]) <= friction * sticks[0]) return sticks;
  const double tangent = std::copysign(friction, sticks[1]);
  const double normal = change[0] / (rod.response(0, 0) + tangent * rod.response(0, 1));
  return {normal, tangent * normal};
}

Vector2d by_newton(const Rod& rod, const Hit& hit) {
  return rod.before + rod.response * impulse_for(rod, hit.restitution, hit.friction);
}

// Normal impulses P_r = e P_c of restitution and compression; friction within the cone of their sum.
Vector2d by_poisson(const Rod& rod, const Hit& hit) {
  const double normal = (1.0 + hit.restitution) * impulse_for(rod, 0.0, hit.friction)[0];
  return rod.before + rod.response * Vector2d(normal, sticking(rod, normal, hit.friction));
}

// m/s; rows that slide are solved to 1e-5 of the change in velocity.
constexpr double kExact = 2e-5;
constexpr double kRestitutions[] = {0.2, 0.5, 1.0};
constexpr double kAlong[] = {-2.0, -1.0, -0.5, -0.3, 0.0, 0.3, 0.5, 1.0, 2.0};

TEST(Restitution, WithoutFrictionBothLawsAreOne) {
  for (const double e : kRestitutions) {
    for (const double along : kAlong) {
      const Hit hit{0.0, e, along};
      Rod newton("newton", hit), poisson("poisson", hit);
      newton.meet();
      poisson.meet();
      EXPECT_LT((newton.after - by_newton(newton, hit)).norm(), kExact) << ::testing::PrintToString(hit);
      EXPECT_LT((poisson.after - newton.after).norm(), kExact) << ::testing::PrintToString(hit);
    }
  }
}

// Friction of 1 sticks where the end is not too fast, of 0.2 slides, and in between slip ends or turns.
TEST(Restitution, PoissonsLawGivesBackAShareOfTheImpulse) {
  double apart = 0.0;
  for (const double friction : {0.2, 0.5, 1.0}) {
    for (const double e : kRestitutions) {
      for (const double along : kAlong) {
        const Hit hit{friction, e, along};
        Rod rod("poisson", hit);
        rod.meet();
        EXPECT_LT((rod.after - by_poisson(rod, hit)).norm(), kExact) << ::testing::PrintToString(hit);
        apart = std::max(apart, (by_poisson(rod, hit) - by_newton(rod, hit)).norm());
      }
    }
  }
  EXPECT_GT(apart, 0.1) << "else it says nothing of which law it is";
}

// Only where Newton's law gains no energy.
TEST(Restitution, NewtonsLawGivesBackAShareOfTheVelocity) {
  for (const double friction : {0.2, 0.5, 1.0}) {
    for (const double e : kRestitutions) {
      for (const double along : kAlong) {
        const Hit hit{friction, e, along};
        Rod rod("newton", hit);
        rod.meet();
        const Vector2d exact = by_newton(rod, hit), impulse = rod.response.inverse() * (exact - rod.before);
        // Work of an impulse: its product with the mean velocity.
        if (impulse.dot(exact + rod.before) > -1e-3) continue;
        EXPECT_LT((rod.after - exact).norm(), kExact) << ::testing::PrintToString(hit);
      }
    }
  }
}

void expect_no_gain(const std::string& impact) {
  for (const double slope : {0.2, 0.6, 1.0, 1.4}) {
    for (const double friction : {0.1, 0.5, 1.0}) {
      for (const double e : kRestitutions) {
        for (const double along : kAlong) {
          const Hit hit{friction, e, along, slope};
          Rod rod(impact, hit);
          rod.meet();
          EXPECT_LE(rod.energy_after, rod.energy_before * (1.0 + 1e-9)) << ::testing::PrintToString(hit);
        }
      }
    }
  }
}

TEST(Restitution, PoissonsLawWinsNoEnergy) {
  expect_no_gain("poisson");
}

TEST(Restitution, NewtonsLawWinsNoEnergy) {
  expect_no_gain("newton");
}

}  // namespace
}  // namespace visum::dynamics::impulse
