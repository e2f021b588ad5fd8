// A drive that trips says which one it is, why, with numbers, and what to try.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hwparts/drive/trip.h"
#include "tests/hwparts/part_bench.h"
#include "tests/hwparts/rig.h"

namespace visum::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

TEST(Trip, NamesTheDriveTheReasonAndARemedy) {
  auto bench = arm_bench();
  EXPECT_EQ(bench.part->trips(), 0u);
  EXPECT_EQ(bench.part->trip_text(), "");
  ASSERT_FALSE(bench.part->set_parameter("Following Error Limit 2", 2e-4));
  bench.set_angles(1.5);
  bench.run(0.5);
  EXPECT_TRUE(bench.module(2) & bit::kTowError);
  EXPECT_EQ(bench.part->trips(), 1u);
  EXPECT_THAT(bench.part->trip_text(),
              AllOf(StartsWith("joint_2: following error 0.000"), HasSubstr("exceeds 2e-04 rad; "),
                    HasSubstr("Following Error Limit, then Reset"), Not(HasSubstr("\n"))));
}

TEST(Trip, IsTheParameterTrippedUntilAReset) {
  auto bench = arm_bench();
  const auto tripped = [&] {
    for (const auto& parameter : bench.part->parameters())
      if (parameter.name == protocol::kTripped) return std::get<std::string>(parameter.value);
    return std::string("none");
  };
  EXPECT_EQ(tripped(), "");
  EXPECT_TRUE(bench.part->set_parameter(protocol::kTripped, std::string("x"))) << "can only be read";
  ASSERT_FALSE(bench.part->set_parameter("Supply Voltage", 5.0));
  bench.run(0.01);
  EXPECT_THAT(tripped(), AllOf(HasSubstr("joint_1: supply 5 V is below 22 V"), HasSubstr("joint_7: supply"),
                               HasSubstr("Supply Voltage to 24")));
  ASSERT_FALSE(bench.part->set_parameter("Supply Voltage", 24.0));
  bench.bump("Reset");
  bench.run(0.01);
  EXPECT_EQ(tripped(), "");
}

TEST(Trip, OfAnotherDriveIsToldByItself) {
  auto bench = arm_bench();
  ASSERT_FALSE(bench.part->set_parameter("Following Error Limit 2", 2e-4));
  ASSERT_FALSE(bench.part->set_parameter("Following Error Limit 1", 4e-4));
  bench.set_angles(1.5);
  for (int i = 0; i < 1000 && bench.part->trips() == 0; ++i) bench.tick();
  ASSERT_EQ(bench.part->trips(), 1u);
  bench.part->controller_lost();
  bench.tick();
  EXPECT_GT(bench.part->trips(), 1u);
  EXPECT_THAT(bench.part->trip_text(), HasSubstr("joint_1: "));
  EXPECT_THAT(bench.part->trip_text(100), "");
  EXPECT_THAT(bench.part->trip_text(bench.part->trips() - 1), Not(HasSubstr("\n"))) << "the last one alone";
}

TEST(Trip, OfALostControllerIsOneLine) {
  auto bench = arm_bench();
  bench.run(0.01);
  bench.part->controller_lost();
  bench.run(0.01);
  EXPECT_THAT(bench.part->trip_text(), StartsWith("all drives: the controller was lost; connect again"));
  EXPECT_THAT(bench.part->trip_text(), Not(HasSubstr("\n")));
}

TEST(Trip, ASecondOneAfterAResetCounts) {
  auto bench = arm_bench();
  for (std::uint64_t i = 1; i <= 2; ++i) {
    bench.part->controller_lost();
    bench.run(0.01);
    EXPECT_EQ(bench.part->trips(), i * 8) << "each of the eight drives";
    bench.bump("Reset");
    bench.run(0.01);
  }
}

TEST(Trip, OfARestoredFaultIsToldWithoutCountingItAgain) {
  auto bench = arm_bench();
  bench.part->set_parameter("Supply Voltage", 5.0);
  bench.run(0.01);
  std::vector<std::byte> bytes;
  {
    hwparts::StateWriter writer(bytes);
    bench.part->save(writer);
  }
  auto other = arm_bench();
  hwparts::StateReader reader(bytes);
  other.part->load(reader);
  other.run(0.01);
  EXPECT_EQ(other.part->trips(), 0u);
  EXPECT_THAT(other.part->trip_text(), HasSubstr("joint_1: supply 5 V is below 22 V"));
}

TEST(Trip, EveryFaultHasItsNumbers) {
  const auto& data = arm_drive(1);
  drive::Trip trip = drive::figures_of(drive::initial_state(data, 0.5, true));
  const auto text = [&](std::uint32_t bits) {
    trip.bits = bits | bit::kError;
    return drive::trip_text(data, trip);
  };
  trip.winding = 131;
  trip.i2t = 1e4;
  EXPECT_THAT(text(bit::kFetTemp), StartsWith("winding at 131 °C exceeds 120 °C; "));
  EXPECT_THAT(text(bit::kIntegralErr), StartsWith("its current was above 5.7 A for too long (10000 of "));
  EXPECT_THAT(text(bit::kIntegralErr), HasSubstr("switch the supply off and on, then Reset"));
  trip.rest_s = 17.2;
  EXPECT_THAT(text(bit::kIntegralErr), HasSubstr("switch the supply off and on, wait 18 s, then Reset"));
  trip.lag = 0.3001;
  trip.tuning.following_error = 0.3;
  EXPECT_THAT(text(bit::kTowError), StartsWith("following error 0.3001 rad exceeds 0.3 rad"));
  EXPECT_THAT(text(bit::kBeyondSoft), HasSubstr("beyond a soft limit, -3.09 to 3.09 rad"));
  EXPECT_THAT(text(bit::kBeyondHard), HasSubstr("beyond a hard limit, -3.14 to 3.14 rad"));
  EXPECT_THAT(text(bit::kBeyondHard | bit::kTowError), HasSubstr(". Also: "));
  EXPECT_EQ(text(0), "");
}

}  // namespace
}  // namespace visum::test
