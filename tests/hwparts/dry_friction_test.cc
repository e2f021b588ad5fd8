// Dry friction of a gear against Coulomb's law: it slides with one effort, holds with another, and sticks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

// A drive with nothing but dry friction and, where asked for, an elastic gear.
drive::DriveData dry_drive(double friction, double holds, bool rigid) {
  auto data = ideal(arm_drive(5));
  data.brake.present = false;
  data.gear.dry_friction = friction;
  data.gear.static_friction = holds;
  if (!rigid) data.gear.stiffness = 60000.0, data.gear.damping = 60.0;
  return data;
}

Rig coasting(const drive::DriveData& data, double tick_s, double speed) {
  Rig rig(data, tick_s);
  rig.plants[0].inertia = 2.0;
  rig.plants[0].joint.velocity = speed;
  auto state = rig.state();
  state.rotor_speed = speed;
  rig.put(state);
  rig.supply(0.0);
  return rig;
}

class DryFriction : public testing::TestWithParam<std::tuple<bool, double>> {
 protected:
  bool rigid() const { return std::get<0>(GetParam()); }
  double tick_s() const { return std::get<1>(GetParam()); }
};

// It slows down evenly, by T / (J + I), and stands after (J + I) ω² / 2T, for ever.
TEST_P(DryFriction, StopsACoastingAxisWhereCoulombsLawSays) {
  const auto data = dry_drive(10.0, 12.0, rigid());
  Rig rig = coasting(data, tick_s(), 0.5);
  const double whole = data.reflected_inertia() + 2.0, stops_after = whole * 0.5 / 10.0;
  rig.run(0.5 * stops_after);
  EXPECT_NEAR(rig.state().rotor_speed, 0.25, 0.02);
  rig.run(0.5 * stops_after + 0.2);  // with time for an elastic gear to come to rest
  EXPECT_NEAR(rig.position(), whole * 0.25 / 20.0, 0.5 * tick_s() * 0.5 + 1e-3);
  const double stood = rig.state().rotor_position;
  rig.run(5.0);
  EXPECT_EQ(rig.state().rotor_position, stood);
  EXPECT_NEAR(rig.state().rotor_speed, 0.0, 1e-15);
}

TEST_P(DryFriction, HoldsALoadUpToTheStaticOneAndSlidesWithTheOther) {
  const auto data = dry_drive(10.0, 12.0, rigid());
  Rig rig = coasting(data, tick_s(), 0.0);
  const auto load = [&](double to) {  // slowly: nothing swings
    for (double part = 0.0; part <= 1.0; part += tick_s()) rig.plants[0].external = part * to, rig.tick();
    rig.plants[0].external = to;
  };
  load(-11.9);
  rig.run(5.0);
  EXPECT_NEAR(rig.state().rotor_position, 0.0, 1e-15);
  load(12.1);
  rig.run(1.0);
  const double before = rig.state().rotor_speed;
  rig.run(0.5);
  const double rises = (rig.state().rotor_speed - before) / 0.5;
  EXPECT_NEAR(rises, 2.1 / (data.reflected_inertia() + 2.0), 1e-2);
}

TEST_P(DryFriction, TakesItsShareOfTheMotorsEffort) {
  const auto data = dry_drive(10.0, 10.0, rigid());
  Rig rig = coasting(data, tick_s(), 0.0);
  rig.supply(24.0);
  const auto under = [&](double effort) {
    rig.drive.move_by_bus({.kind = drive::MotionKind::kCurrent, .target = effort / data.effort_per_amp()});
    rig.run(0.5);
    const double before = rig.state().rotor_speed;
    rig.run(0.2);
    return (rig.state().rotor_speed - before) / 0.2;
  };
  EXPECT_NEAR(under(9.9), 0.0, 1e-12);
  EXPECT_NEAR(rig.state().rotor_position, 0.0, 1e-12);
  EXPECT_NEAR(under(13.0), 3.0 / (data.reflected_inertia() + 2.0), 1e-2);
}

// It only ever takes energy away, also where the load makes it stick and slide by turns.
TEST_P(DryFriction, NeverGivesEnergy) {
  const auto data = dry_drive(10.0, 14.0, rigid());
  Rig rig = coasting(data, tick_s(), 0.3);
  rig.plants[0].gravity = 40.0;
  const auto energy = [&] {
    const double torsion = rigid() ? 0.0 : rig.state().rotor_position - rig.position();
    const double speed = rig.plants[0].joint.velocity;
    return 0.5 * data.reflected_inertia() * std::pow(rig.state().rotor_speed, 2) + speed * speed +
           40.0 * (1.0 - std::cos(rig.position())) + 0.5 * data.gear.stiffness * torsion * torsion;
  };
  const double start = energy();
  double most = start;
  for (double t = 0.0; t < 5.0; t += tick_s()) rig.tick(), most = std::max(most, energy());
  EXPECT_LT(most, start * (1.0 + 20.0 * tick_s()));
  EXPECT_LT(energy(), 0.2 * start);
}

INSTANTIATE_TEST_SUITE_P(GearsAndTicks, DryFriction,
                         testing::Combine(testing::Bool(), testing::Values(0.0005, 0.001, 0.004)),
                         [](const auto& info) {
                           const double us = 1e6 * std::get<1>(info.param);
                           return std::string(std::get<0>(info.param) ? "Rigid" : "Elastic") +
                                  std::to_string(std::lround(us)) + "us";
                         });

// A drive whose loop is a soft spring, with little damping.
drive::DriveData soft_drive(double friction, double holds) {
  auto data = dry_drive(friction, holds, true);
  data.loop.velocity_bandwidth = 10.0;
  data.loop.integral_time = 0.0;
  return data;
}

struct Slips {
  int starts = 0;
  double first_s = 0.0, last_s = 0.0;  // when it started to slide
  double standing_s = 0.0, most_lag = 0.0;
};

// Follows a slow ramp for 20 s.
Slips creep(const drive::DriveData& data, double speed) {
  Rig rig(data);
  rig.plants[0].inertia = 2.0;
  rig.command = {3.0, speed, true};
  Slips slips;
  bool stood = true;
  for (int k = 0; k < 20000; ++k) {
    rig.tick();
    const bool stands = std::abs(rig.state().rotor_speed) < 1e-12;
    if (stands) slips.standing_s += rig.tick_s;
    if (stood && !stands) {
      slips.last_s = k * rig.tick_s;
      if (++slips.starts == 1) slips.first_s = slips.last_s;
    }
    stood = stands;
    slips.most_lag = std::max(slips.most_lag, rig.state().setpoint.position - rig.position());
  }
  return slips;
}

// An axis that the loop's stiffness k draws slowly moves in jumps where it holds more than it slides with,
// and evenly where it does not. It starts at the lag where the loop's effort is the static friction, and
// sticks again after half an oscillation of damping ratio ζ: then the spring is slack by (Tₛ - T)(1 +
// exp(-πζ/√(1-ζ²))) / k, which the ramp takes up.
TEST(StickSlip, HasThePeriodOfAMassOnASpringAndABelt) {
  const double friction = 10.0, holds = 20.0, speed = 0.02;
  const auto data = soft_drive(friction, holds);
  const double damping = data.loop.velocity_bandwidth * data.reflected_inertia();
  const double stiffness = data.loop.position_gain * damping, mass = data.reflected_inertia() + 2.0;
  const double zeta = 0.5 * damping / std::sqrt(stiffness * mass), under = std::sqrt(1.0 - zeta * zeta);
  const double slack = (holds - friction) * (1.0 + std::exp(-std::numbers::pi * zeta / under)) / stiffness;
  const double slide_s = std::numbers::pi / (under * std::sqrt(stiffness / mass));

  const Slips slips = creep(data, speed);
  ASSERT_GT(slips.starts, 5);
  EXPECT_NEAR((slips.last_s - slips.first_s) / (slips.starts - 1), slack / speed + slide_s,
              0.1 * slack / speed);
  EXPECT_NEAR(slips.most_lag, (holds - damping * speed) / stiffness, 0.02 * holds / stiffness);
  EXPECT_GT(slips.standing_s, 10.0);
}

TEST(StickSlip, IsNotThereWithoutStaticFriction) {
  const Slips slips = creep(soft_drive(0.0, 0.0), 0.02);
  EXPECT_EQ(slips.starts, 1);
  EXPECT_LT(slips.standing_s, 0.01);
  const Slips even = creep(soft_drive(10.0, 10.0), 0.02);
  EXPECT_EQ(even.starts, 1) << "what slides as hard as it holds starts once";
}

TEST(StickSlip, IsInTheSnapshot) {
  auto data = dry_drive(10.0, 20.0, false);
  data.loop.period = 0.004;
  Rig first(data), second(data);
  first.command = {1.0, 0.002, true};
  first.run(1.2347);  // between two runs of the loop
  std::vector<std::byte> bytes;
  {
    hwparts::StateWriter writer(bytes);
    first.drive.save(writer);
  }
  hwparts::StateReader reader(bytes);
  second.run(0.333);
  second.drive.load(reader);
  second.command = first.command;
  second.plants = first.plants;
  for (int k = 0; k < 2000; ++k) {
    first.tick(), second.tick();
    ASSERT_EQ(first.state().rotor_position, second.state().rotor_position) << k;
    ASSERT_EQ(first.state().current, second.state().current) << k;
  }
}

}  // namespace
}  // namespace visum::test
