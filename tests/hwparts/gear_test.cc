// The gear against closed form: torsion, lost motion, coupling, energy, brake.
#include "hwparts/drive/gear.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

// A drive without motor, brake and friction: only rotor, spring and load are left.
drive::DriveData passive(drive::DriveData data) {
  data.gear.viscous_friction = data.gear.coulomb_friction = 0.0;
  data.brake.present = false;
  return data;
}

double energy(const Rig& rig) {
  const auto& data = rig.drive.data();
  const auto& state = rig.state();
  const double torsion = state.rotor_position - rig.position();
  const double stretch = std::max(0.0, std::abs(torsion) - 0.5 * data.gear.backlash);
  const double speed = rig.plants[0].joint.velocity;
  return 0.5 * data.reflected_inertia() * state.rotor_speed * state.rotor_speed +
         0.5 * rig.plants[0].inertia * speed * speed + 0.5 * data.gear.stiffness * stretch * stretch;
}

TEST(Gear, TorsionUnderLoadIsLoadOverStiffness) {
  auto data = arm_drive(2);
  data.gear.backlash = 0.0;
  Rig rig(data);
  rig.plants[0].external = -60.0;
  rig.run(5.0);
  EXPECT_NEAR(rig.state().rotor_position - rig.position(), 60.0 / data.gear.stiffness, 1e-8);
  EXPECT_NEAR(rig.state().gear_effort, 60.0, 1e-2);
}

TEST(Gear, EncoderDoesNotSeeTorsionButTheJointDoes) {
  Rig rig(arm_drive(2));
  rig.plants[0].external = -60.0;
  rig.run(5.0);
  EXPECT_NEAR(rig.state().measured_position, 0.0, 5e-6);
  EXPECT_NEAR(rig.position(), -60.0 / 60000.0 - 0.5 * 1.5e-4, 1e-5);
}

TEST(Gear, LostMotionIsExactlyTheBacklash) {
  auto data = arm_drive(1);
  const double load = 3.0;
  Rig up(data), down(data);
  up.plants[0].external = load;
  down.plants[0].external = -load;
  up.run(8.0);
  down.run(8.0);
  const double torsion = 2.0 * load / data.gear.stiffness;
  const double rotor_shift = up.state().rotor_position - down.state().rotor_position;
  EXPECT_NEAR(up.position() - down.position() - rotor_shift, data.gear.backlash + torsion, 1e-7);
}

TEST(Gear, NothingIsTransmittedInsideThePlay) {
  auto data = arm_drive(1);
  data.gear.backlash = 0.02;
  Rig rig(data);
  rig.plants[0].joint.velocity = 0.01;  // coasts through half of the play in 1 s
  for (int k = 0; k < 900; ++k) {
    rig.tick();
    ASSERT_EQ(rig.plants[0].joint.effort, 0.0) << k;
  }
  EXPECT_NEAR(rig.plants[0].joint.velocity, 0.01, 1e-12);
  rig.run(0.3);
  EXPECT_LT(rig.plants[0].joint.velocity, 0.0);  // bounced off the flank
}

// Both ways of an engine to move joints.
class GearOfBothOrders : public testing::TestWithParam<bool> {
 protected:
  drive::Load load_of(double inertia) const { return {GetParam(), inertia}; }
};
INSTANTIATE_TEST_SUITE_P(ByMeanSpeed, GearOfBothOrders, testing::Bool());

TEST_P(GearOfBothOrders, FlankPushesButNeverPulls) {
  auto data = arm_drive(1);
  Rig rig(data, 0.001, 0.0, 1, load_of(1.0));
  rig.plants[0].external = -20.0;
  rig.run(3.0);
  rig.plants[0].external = 20.0;
  for (int k = 0; k < 3000; ++k) {
    const double torsion = rig.state().rotor_position - rig.position();
    rig.tick();
    const double effort = rig.plants[0].joint.effort;
    if (torsion > 0.5 * data.gear.backlash) {
      EXPECT_GE(effort, 0.0) << k;
    }
    if (torsion < -0.5 * data.gear.backlash) {
      EXPECT_LE(effort, 0.0) << k;
    }
  }
}

TEST(Gear, OscillatesWithTheFrequencyOfTwoMassesAndASpring) {
  auto data = passive(arm_drive(5));
  data.gear.backlash = data.gear.damping = 0.0;
  const double h = 1e-5, inertia = 2.0;
  Rig rig(data, h);
  rig.supply(0.0);
  rig.plants[0].inertia = inertia;
  rig.plants[0].joint.position = -1e-4;  // stretched, at rest
  int crossings = 0;
  double before = 1e-4, elapsed = 0.0, first = 0.0, last = 0.0;
  for (int k = 1; k <= 100'000; ++k) {
    rig.tick();
    elapsed += h;
    const double torsion = rig.state().rotor_position - rig.position();
    if (before > 0.0 && torsion <= 0.0) {
      if (crossings++ == 0) first = elapsed;
      last = elapsed;
    }
    before = torsion;
  }
  const double k = data.gear.stiffness, j = data.reflected_inertia();
  const double frequency = std::sqrt(k * (1.0 / j + 1.0 / inertia)) / (2.0 * std::numbers::pi);
  EXPECT_NEAR((crossings - 1) / (last - first), frequency, 0.005 * frequency);
}

// Rotor and load on a spring with a damper, without play, and a torque on the load: the torsion after 0.2 s,
// less that of the closed form, the damped oscillation of the reduced inertia m about the torsion at rest.
double error_of_torsion(double h, bool by_mean_speed) {
  constexpr double kInertia = 2.0, kLoad = 30.0, kSeconds = 0.2;
  auto data = passive(arm_drive(5));
  data.gear.backlash = 0.0;
  data.gear.damping = 20.0;
  Rig rig(data, h, 0.0, 1, {by_mean_speed, kInertia});
  rig.supply(0.0);
  rig.plants[0].external = kLoad;
  rig.run(kSeconds);
  const double m = 1.0 / (1.0 / data.reflected_inertia() + 1.0 / kInertia);
  const double rest = -kLoad * m / kInertia / data.gear.stiffness, decay = 0.5 * data.gear.damping / m;
  const double turning = std::sqrt(data.gear.stiffness / m - decay * decay);
  const double swing = std::cos(turning * kSeconds) + decay / turning * std::sin(turning * kSeconds);
  return std::abs(rig.state().rotor_position - rig.position() -
                  rest * (1.0 - std::exp(-decay * kSeconds) * swing)) /
         std::abs(rest);
}

// Orders come out as 1.996 and 2.016, nearer to 2 with shorter ticks. An error whose fiftieth part is of
// first order would be 0.03 away.
constexpr double kOffOrder = 0.025;

TEST(Gear, IsOfSecondOrderWhereJointsMoveByTheirMeanSpeed) {
  const double coarse = error_of_torsion(1e-3, true), fine = error_of_torsion(5e-4, true);
  EXPECT_LT(coarse, 0.004);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, kOffOrder);
  EXPECT_LT(coarse, 0.1 * error_of_torsion(1e-3, false)) << "backward Euler, of first order";
}

// The same of friction alone: a rotor on a rigid gear coasts out.
TEST(Gear, FrictionIsOfSecondOrderToo) {
  const auto speed_after = [](double h) {
    auto data = ideal(arm_drive(5));
    data.gear.viscous_friction = 10.0;
    data.gear.coulomb_friction = 15.0;
    data.gear.coulomb_speed = 0.2;
    data.brake.present = false;
    Rig rig(data, h, 0.0, 1, {true, 1.0});
    rig.supply(0.0);
    rig.plants[0].joint.velocity = 0.5;
    auto state = rig.state();
    state.rotor_speed = 0.5;
    rig.put(state);
    rig.run(0.1);
    return rig.plants[0].joint.velocity;
  };
  const double exact = speed_after(1e-6);
  const double coarse = std::abs(speed_after(4e-3) - exact), fine = std::abs(speed_after(2e-3) - exact);
  EXPECT_GT(exact, 0.05);
  EXPECT_LT(coarse, 8e-5);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, kOffOrder);
}

// A kick to a light link behind a stiff gear is over within a few ticks, also where ticks are too long for
// its oscillation, and the gear feels little more than what takes the kick in one tick.
TEST(Gear, LightLinkComesToRestWhateverTheTick) {
  for (const double h : {0.001, 0.002, 0.005, 0.01}) {
    auto data = arm_drive(7);
    data.gear.backlash = 0.0;
    data.brake.present = false;
    Rig rig(data, h, 0.0, 1, {true, 0.003});
    rig.supply(0.0);
    rig.plants[0].joint.velocity = 0.5;
    double effort = 0.0;
    for (int k = 0; k < 12; ++k) {
      rig.tick();
      effort = std::max(effort, std::abs(rig.plants[0].joint.effort));
    }
    EXPECT_LT(std::abs(rig.plants[0].joint.velocity), 5e-3) << h;
    EXPECT_LT(effort, 0.003 * 0.5 / h * 1.5) << h;
  }
}

// Rotor and load rattle through the play. The energy must never grow.
class GearEnergy : public testing::TestWithParam<std::tuple<double, bool>> {};

TEST_P(GearEnergy, NeverGrowsWhateverTheTickAndThePlay) {
  const auto [h, by_mean_speed] = GetParam();
  for (const double backlash : {0.0, 1e-5, 1e-4, 1e-2}) {
    for (const auto& [inertia, damping] : std::vector<std::pair<double, double>>{
             {0.01, 0.0}, {1.0, 0.0}, {100.0, 0.0}, {0.01, 49.0}, {1.0, 49.0}}) {
      auto data = passive(arm_drive(3));
      data.gear.damping = damping;
      data.gear.backlash = backlash;
      Rig rig(data, h, 0.0, 1, {by_mean_speed, inertia});
      rig.supply(0.0);
      rig.plants[0].joint.velocity = 0.5;
      double before = energy(rig);
      const double start = before;
      for (int k = 0; k < 3000; ++k) {
        rig.tick();
        double most = before;
        // With a damper the gear of second order may lead it through the spring for some ticks (gear.h).
        if (by_mean_speed && damping > 0.0) most = k < 20 ? 20.0 * start : start;
        ASSERT_LE(energy(rig), most * (1.0 + 1e-9) + 1e-9 * start)
            << backlash << " " << inertia << " " << damping << " " << k;
        before = energy(rig);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Ticks, GearEnergy,
                         testing::Combine(testing::Values(0.001, 0.002, 0.004, 0.005), testing::Bool()));

TEST_P(GearOfBothOrders, MomentumOfRotorAndLoadIsKept) {
  auto data = passive(arm_drive(3));
  Rig rig(data, 0.001, 0.0, 1, load_of(1.0));
  rig.supply(0.0);
  rig.plants[0].joint.velocity = 0.5;
  rig.run(2.0);
  const double sum = rig.plants[0].inertia * rig.plants[0].joint.velocity +
                     data.reflected_inertia() * rig.state().rotor_speed;
  EXPECT_NEAR(sum, 0.5, 1e-9);
}

TEST(Gear, RigidGearAddsTheRotorsInertia) {
  auto data = passive(ideal(arm_drive(4)));
  Rig rig(data);
  rig.supply(0.0);
  rig.plants[0].external = 5.0;
  rig.run(1.0);
  EXPECT_NEAR(rig.plants[0].joint.velocity, 5.0 / (1.0 + data.reflected_inertia()), 1e-9);
  EXPECT_EQ(rig.state().rotor_position, rig.position());
}

TEST_P(GearOfBothOrders, BreaksRatherThanTransmitMoreThanItsLimit) {
  auto data = arm_drive(7);
  Rig rig(data, 0.001, 0.0, 1, load_of(1.0));
  rig.plants[0].joint.velocity = 5.0;  // a blow
  double most = 0.0;
  for (int k = 0; k < 200; ++k) {
    rig.tick();
    most = std::max(most, std::abs(rig.plants[0].joint.effort));
  }
  EXPECT_LE(most, data.gear.breaking_effort * (1.0 + 1e-12));
  EXPECT_GT(most, data.gear.peak_effort);
}

TEST(Gear, CountsOverloadsOfItsRatingOnceEach) {
  auto data = arm_drive(7);
  Rig rig(data);
  EXPECT_EQ(rig.state().overloads, 0u);
  for (std::uint64_t blow = 1; blow <= 3; ++blow) {
    const double load = 2.0 * data.gear.peak_effort;
    for (double part = 0.0; part <= 2.0; part += 0.0005) {  // up and down, slowly: nothing swings
      rig.plants[0].external = load * std::min(part, 2.0 - part);
      rig.tick();
    }
    rig.run(1.0);
    EXPECT_EQ(rig.state().overloads, blow);
  }
  EXPECT_GT(rig.state().peak_effort, data.gear.peak_effort);
  rig.reset();
  EXPECT_EQ(rig.state().overloads, 0u);
  EXPECT_EQ(rig.state().peak_effort, 0.0);
}

TEST(Brake, HoldsWithoutPowerUpToItsTorqueAndSlipsBeyond) {
  for (const bool rigid : {false, true}) {
    auto data = rigid ? ideal(arm_drive(4)) : arm_drive(4);
    Rig rig(data);
    rig.supply(0.0);
    rig.run(0.1);
    ASSERT_TRUE(rig.has(bit::kBrakeActive));
    const double torsion =
        rigid ? 0.0 : 0.95 * data.brake.holding_effort / data.gear.stiffness + data.gear.backlash;
    for (double part = 0.0; part <= 1.0; part += 0.0005) {  // slowly: nothing swings
      rig.plants[0].external = 0.95 * part * data.brake.holding_effort;
      rig.tick();
    }
    rig.run(2.0);
    EXPECT_LT(std::abs(rig.position()), torsion + 1e-9) << rigid;
    rig.plants[0].external = 1.3 * data.brake.holding_effort;
    rig.run(2.0);
    EXPECT_GT(rig.position(), 0.05) << rigid;
  }
}

TEST(Brake, StopsAMovingRotorWithItsTorqueAndHoldsItStill) {
  auto data = ideal(arm_drive(4));
  data.gear.stiffness = 30000.0;
  data.gear.damping = 66.0;
  data.brake.engage_time = 0.0;
  Rig rig(data);
  rig.plants[0].inertia = 0.001;
  rig.plants[0].joint.velocity = 0.5;
  auto running = rig.state();
  running.rotor_speed = 0.5;
  rig.put(running);
  rig.supply(0.0);
  const double stopping = 0.5 * data.reflected_inertia() / data.brake.holding_effort;
  rig.run(0.5 * stopping);
  EXPECT_NEAR(rig.state().rotor_speed, 0.25, 0.02);
  rig.run(0.6 * stopping + 0.002);
  EXPECT_EQ(rig.state().rotor_speed, 0.0);
  const double stood = rig.state().rotor_position;
  rig.run(1.0);
  EXPECT_EQ(rig.state().rotor_position, stood);
}

}  // namespace
}  // namespace visum::test
