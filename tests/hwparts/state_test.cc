// The state of a part is complete: the saved bytes, and nothing else, decide every bit of the future.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

PartBench slow_arm() {
  return PartBench("amtec_arm", arm_context(0.002, 0.1));
}

// One random command, fault or parameter.
void disturb(PartBench& bench, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto pick = random() % 12;
  if (pick < 5) bench.in("Desired Angle " + std::to_string(1 + random() % 7)) = 3.0 * unit(random);
  if (pick == 5)
    bench.in("Desired Finger Position 1") = bench.in("Desired Finger Position 2") =
        0.02 + 0.01 * unit(random);
  if (pick == 6) bench.bump("Reset");
  if (pick == 7 && random() % 4 == 0) bench.bump("Halt");
  if (pick == 8 && random() % 4 == 0) bench.bump("Home");
  if (pick == 9) bench.plants[random() % 7].external = 40.0 * unit(random);
  if (pick == 10 && random() % 4 == 0) bench.part->controller_lost();
  if (pick == 11) bench.part->set_parameter("Supply Voltage", random() % 5 == 0 ? 0.0 : 24.0);
}

void wander(PartBench& bench, std::uint64_t seed, int steps) {
  std::mt19937_64 random(seed);
  for (int k = 0; k < steps; ++k) {
    disturb(bench, random);
    bench.run(0.03);
  }
}

// Puts the mechanics and the inputs of one bench into another.
void copy_world(const PartBench& from, PartBench& to) {
  to.plants = from.plants;
  to.inputs = from.inputs;
}

class PartStateFuzz : public testing::TestWithParam<int> {};

TEST_P(PartStateFuzz, RestoringAndGoingOnGivesTheSameBits) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  auto first = slow_arm();
  wander(first, seed, 150);
  const auto snapshot = first.save();

  auto second = slow_arm();
  wander(second, seed + 77, 60);  // brings it into quite another state
  second.load(snapshot);
  copy_world(first, second);
  ASSERT_EQ(second.save(), snapshot);
  for (int k = 0; k < 50; ++k) {
    std::mt19937_64 same_a(seed * 1000 + static_cast<std::uint64_t>(k)), same_b = same_a;
    disturb(first, same_a);
    disturb(second, same_b);
    first.run(0.02);
    second.run(0.02);
    ASSERT_EQ(first.outputs, second.outputs) << k;
    ASSERT_EQ(first.save(), second.save()) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, PartStateFuzz, testing::Range(1, 9));

TEST(PartState, ResetGoesBackToTheStateAfterConstruction) {
  const auto fresh = slow_arm();
  auto used = slow_arm();
  used.part->set_parameter("Position Gain 3", 5.0);
  used.part->set_parameter("On Controller Lost", std::string("hold"));
  wander(used, 5, 100);
  used.part->reset();
  EXPECT_EQ(used.save(), fresh.save());
}

TEST(PartState, IsSavedInAFixedNumberOfBytes) {
  auto bench = slow_arm();
  const auto size = bench.save().size();
  wander(bench, 3, 50);
  EXPECT_EQ(bench.save().size(), size);
}

TEST(PartState, ShortBytesAreAnErrorAndNoCrash) {
  auto bench = slow_arm();
  auto bytes = bench.save();
  bytes.pop_back();
  EXPECT_THROW(bench.load(bytes), std::out_of_range);
}

// A drive whose whole state was overwritten is restored by load(): no field is forgotten.
TEST(DriveState, PoisonDoesNotOutliveALoad) {
  for (const int poison : {0x00, 0x01, 0x3f}) {
    Rig rig(arm_drive(2));
    rig.command.target = 1.0;
    rig.plants[0].gravity = 60.0;
    rig.run(1.0);
    rig.drive.set_home_offset(0.25);
    rig.drive.apply_home_offset();
    std::vector<std::byte> saved;
    {
      hwparts::StateWriter writer(saved);
      drive::save(rig.state(), writer);
    }

    Rig other(arm_drive(2));
    other.command = rig.command;
    static_assert(std::is_trivially_copyable_v<drive::DriveState>);
    // Only this test writes into a drive from outside. It must poison every field, to find one that load()
    // forgets.
    auto& inside = const_cast<drive::DriveState&>(other.state());
    std::memset(static_cast<void*>(&inside), poison, sizeof(drive::DriveState));
    hwparts::StateReader reader(saved);
    other.drive.load(reader);
    EXPECT_TRUE(reader.at_end());
    other.plants = rig.plants;
    for (int k = 0; k < 2000; ++k) {
      if (k == 500) rig.command.target = other.command.target = 0.2;
      if (k == 1000) {
        rig.halt();
        other.halt();
      }
      if (k == 1500) {
        for (auto* each : {&rig, &other}) {
          each->drive.set_home_offset(0.1);
          each->drive.apply_home_offset();
        }
      }
      rig.tick();
      other.tick();
      ASSERT_EQ(rig.position(), other.position()) << k;
      ASSERT_EQ(rig.word(), other.word()) << k;
      ASSERT_EQ(rig.state().zero_offset, other.state().zero_offset) << k;
    }
  }
}

TEST(PartState, PublishWithoutActOnlyReadsTheJoints) {
  auto bench = slow_arm();
  wander(bench, 4, 20);
  const auto before = bench.save();
  std::vector<hwparts::JointSample> samples;
  for (const auto& plant : bench.plants) samples.push_back(plant.joint);
  bench.part->publish(samples, bench.outputs);
  EXPECT_EQ(bench.save(), before);
}

}  // namespace
}  // namespace visum::test
