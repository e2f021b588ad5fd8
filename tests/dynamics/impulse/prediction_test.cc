#include "server/dynamics/impulse/prediction.h"

#include <gtest/gtest.h>

#include "tests/dynamics/lab.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/serial_models.h"
#include "tests/dynamics/rollback.h"

namespace visum::dynamics::impulse {
namespace {

// A reaction F(t) = 2 + 3 t: its impulse in a step, and the impulse that closes a gap (prediction.h).
double given(double t, double h) {
  return h * (2.0 + 3.0 * (t + 0.5 * h));
}
double closing(double t, double h) {
  return h * ((2.0 + 3.0 * t) / 2.0 + 3.0 * h / 6.0);
}

JointImpulse along_x(double size) {
  return {{size, 0.0, 0.0}, {0.0, -size, 0.0}};
}

void take_step(Prediction& prediction, double t, double h) {
  prediction.begin(h);
  prediction.ahead()[0] = along_x(closing(t, h));
  prediction.after()[0] = along_x(given(t, h) - closing(t, h));
  prediction.end();
}

TEST(Prediction, ForeseesALinearReactionWhateverTheStepsLengths) {
  Prediction prediction(1);
  double t = 0.0;
  for (const double h : {0.01, 0.03, -0.02, 0.015, 0.01}) {
    take_step(prediction, t, h);
    t += h;
  }
  prediction.begin(0.02);
  ASSERT_TRUE(prediction.is_ready());
  const JointImpulse foreseen = prediction.at(0);
  EXPECT_NEAR(foreseen.w.x(), closing(t, 0.02), 1e-8);
  EXPECT_NEAR(foreseen.v.y(), -closing(t, 0.02), 1e-8);
}

TEST(Prediction, KnowsNothingBeforeTwoStepsAndAfterForgetting) {
  Prediction prediction(1);
  prediction.begin(0.01);
  EXPECT_FALSE(prediction.is_ready());
  take_step(prediction, 0.0, 0.01);
  take_step(prediction, 0.01, 0.01);
  prediction.begin(0.01);
  EXPECT_TRUE(prediction.is_ready());
  prediction.forget();
  prediction.begin(0.01);
  EXPECT_FALSE(prediction.is_ready());
}

TEST(Prediction, BytesOfAnotherKindCountForNothing) {
  Prediction prediction(1);
  for (int i = 0; i < 4; ++i) take_step(prediction, 0.01 * i, 0.01);
  std::vector<std::byte> bytes(prediction.bytes());
  prediction.write(bytes);
  Prediction other(1);
  other.read(bytes);
  other.begin(0.01);
  EXPECT_TRUE(other.is_ready());
  for (const std::vector<std::byte>& wrong :
       {std::vector<std::byte>(bytes.size()), std::vector<std::byte>(bytes.size() - 1), {}}) {
    other.read(wrong);
    other.begin(0.01);
    EXPECT_FALSE(other.is_ready());
  }
}

std::string name_of(const ::testing::TestParamInfo<const char*>& row) {
  std::string name = row.param;
  std::erase(name, '-');
  return name;
}

class PredictedArm : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Orders, PredictedArm,
                         ::testing::Values("impulse", "impulse-order4", "impulse-order6"), name_of);

// Only its joints hold it, so every step is foreseen.
TEST_P(PredictedArm, GoesOnWithTheSameBitsFromARestoredState) {
  const auto setting = physics::engine_row(GetParam()).setting;
  dynamics::testing::Lab straight(physics::arm7(setting, 1e-3)), rolled(physics::arm7(setting, 1e-3));
  EXPECT_EQ(dynamics::testing::first_difference_when_rolled_back(straight, rolled, 100), std::nullopt);
}

// The impulses that were kept belong to another motion. That costs one more solution, and nothing else.
TEST_P(PredictedArm, StaysTogetherWhenItIsThrownElsewhere) {
  const auto setting = physics::engine_row(GetParam()).setting;
  dynamics::testing::Lab lab(physics::arm7(setting, 1e-3)), other(physics::arm7(setting, 1e-3));
  lab.run_ticks(400);
  other.state.engines = lab.state.engines;
  dynamics::testing::Lab fresh(physics::arm7(setting, 1e-3));
  other.run_ticks(100);
  fresh.run_ticks(100);
  for (std::size_t i = 0; i < fresh.state.bodies.size(); ++i)
    EXPECT_LT((other.state.bodies[i].p_WC - fresh.state.bodies[i].p_WC).norm(), 1e-8);
}

// Closed loops are foreseen, too, away from poses where all bars lie on a line.
class PredictedLoops : public PredictedArm {};
INSTANTIATE_TEST_SUITE_P(Orders, PredictedLoops,
                         ::testing::Values("impulse", "impulse-order4", "impulse-order6"), name_of);

TEST_P(PredictedLoops, GoOnWithTheSameBitsFromARestoredState) {
  const auto setting = physics::engine_row(GetParam()).setting;
  dynamics::testing::Lab straight(physics::four_bars(setting, 1e-3, 2)),
      rolled(physics::four_bars(setting, 1e-3, 2));
  EXPECT_EQ(dynamics::testing::first_difference_when_rolled_back(straight, rolled, 100), std::nullopt);
}

// The kept impulses of another motion would leave gaps and energy if the look-ahead did not check them.
TEST_P(PredictedLoops, StayTogetherWhenTheyAreThrownElsewhere) {
  const auto setting = physics::engine_row(GetParam()).setting;
  dynamics::testing::Lab lab(physics::four_bars(setting, 1e-3, 2)),
      other(physics::four_bars(setting, 1e-3, 2)), fresh(physics::four_bars(setting, 1e-3, 2));
  lab.run_ticks(700);
  other.state.engines = lab.state.engines;
  other.run_ticks(100);
  fresh.run_ticks(100);
  for (std::size_t i = 0; i < fresh.state.bodies.size(); ++i)
    EXPECT_LT((other.state.bodies[i].p_WC - fresh.state.bodies[i].p_WC).norm(), 1e-9);
}

}  // namespace
}  // namespace visum::dynamics::impulse
