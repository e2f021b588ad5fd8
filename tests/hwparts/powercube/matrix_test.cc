// Every command in every state of a module: it is answered as it should be, and nothing moves that must not.
#include <cmath>
#include <functional>

#include "hwparts/drive/supervision.h"
#include "tests/hwparts/powercube/bus_bench.h"

namespace visum::test {
namespace {

struct Command {
  const char* name;
  Message message;
  std::size_t answer;  // its size in bytes
  bool moves = false;
};

std::vector<Command> commands() {
  using S = BusBench;
  return {
      {"Reset", {0x00}, 1},
      {"Home", {0x01}, 1},
      {"Halt", {0x02}, 1},
      {"ToggleHome", {0x03}, 0},
      {"Internal", {0x04, 0, 0, 0, 0, 0, 0, 0}, 0},
      {"WatchdogAddressed", {0x07}, 0},
      {"SetParameter", with_value({0x08, 0x4F}, 0.1f), 3},
      {"SetUnknownParameter", with_value({0x08, 0x11}, 0.1f), 3},
      {"RecalcPid", {0x09}, 1},
      {"GetFloat", {0x0A, 0x3C}, 6},
      {"GetState", {0x0A, 0x27}, 6},
      {"GetWord", {0x0A, 0x1D}, 4},
      {"GetByte", {0x0A, 0x20}, 3},
      {"GetCombined", {0x0A, 0x62}, 8},
      {"GetUnknown", {0x0A, 0x11}, 0},
      {"Ramp", with_value({0x0B, 0x04}, 0.5f), 3, true},
      {"Step", S::step(0x06, 0.5f, 500), 3, true},
      {"Velocity", with_value({0x0B, 0x07}, 0.2f), 3, true},
      {"Current", with_value({0x0B, 0x08}, 2.0f), 3, true},
      {"RampIncrements", with_value({0x0B, 0x09}, 100'000), 3, true},
      {"StepIncrements",
       [] {
         auto m = with_value({0x0B, 0x0B}, 100'000);
         powercube::put_value(m, std::uint16_t{500});
         return m;
       }(),
       3, true},
      {"VelocityIncrements", with_value({0x0B, 0x0C}, 50'000), 3, true},
      {"CurrentDigits", with_value({0x0B, 0x0D}, std::int16_t{100}), 3, true},
      {"RampExtended", with_value({0x0B, 0x0E}, 0.5f), 8, true},
      {"StepExtended", S::step(0x10, 0.5f, 500), 8, true},
      {"VelocityExtended", with_value({0x0B, 0x11}, 0.2f), 8, true},
      {"CurrentExtended", with_value({0x0B, 0x12}, 2.0f), 8, true},
      {"RampIncrementsExtended", with_value({0x0B, 0x13}, 100'000), 8, true},
      {"StepIncrementsExtended",
       [] {
         auto m = with_value({0x0B, 0x15}, 100'000);
         powercube::put_value(m, std::uint16_t{500});
         return m;
       }(),
       8, true},
      {"VelocityIncrementsExtended", with_value({0x0B, 0x16}, 50'000), 8, true},
      {"CurrentDigitsExtended", with_value({0x0B, 0x17}, std::int32_t{100}), 8, true},
      {"CosineLoop", S::step(0x18, 0.5f, 500), 3, true},
      {"RampLoop", S::step(0x19, 0.5f, 500), 0},
      {"UnknownMove", with_value({0x0B, 0x05}, 0.5f), 0},
      {"LegacyStep", {0x0D, 0, 0, 0, 0, 0, 0}, 0},
      {"SaveParameters", {0x10}, 1},
      {"UnknownCommand", {0x55}, 0},
  };
}

struct State {
  const char* name;
  std::function<void(BusBench&)> enter;
  bool takes_motion;
  std::uint32_t bits;  // of the state word, once entered
};

void stuck(BusBench& bench) {
  bench.plants[0].upper = 0.02;
  bench.ramp(1, 1.0f);
  bench.wait_for(1, bit::kTowError, 3.0);
  bench.run(1.0);
}

std::vector<State> states() {
  return {
      {"Standing", [](BusBench&) {}, true, bit::kHomeOk | bit::kRampEnd},
      {"Ramping", [](BusBench& b) { b.ramp(1, 1.0f), b.run(0.5); }, true, bit::kMotion},
      {"Stepping", [](BusBench& b) { b.send(1, BusBench::step(0x06, 0.3f, 2000)), b.run(0.5); }, true,
       bit::kInProgress},
      {"Queued",
       [](BusBench& b) {
         for (int i = 0; i < 2; ++i) b.send(1, BusBench::step(0x06, 0.3f, 2000));
         b.run(0.1);
       },
       true, bit::kFullBuffer},
      {"Running",
       [](BusBench& b) {
         b.send(1, with_value({0x0B, 0x07}, 0.2f)), b.run(0.5);
       },
       true, bit::kRampSteady},
      {"Pressing",
       [](BusBench& b) {
         b.plants[0].upper = 0.0, b.send(1, with_value({0x0B, 0x08}, 1.0f)), b.run(0.5);
       },
       true, bit::kRampEnd},
      {"Homing", [](BusBench& b) { b.ramp(1, 0.3f), b.run(1.0), b.send(1, {0x01}), b.run(0.2); }, false,
       bit::kMotion},
      {"Halted", [](BusBench& b) { b.send(1, {0x02}), b.run(0.2); }, false, bit::kHalted},
      {"TowError", stuck, false, bit::kTowError | bit::kError},
      {"BeyondSoft", [](BusBench& b) { b.set(1, 0x46, 0.1f), b.ramp(1, 0.5f), b.run(2.0); }, false,
       bit::kBeyondSoft | bit::kError},
      {"WatchdogExpired",
       [](BusBench& b) { b.set<std::uint32_t>(1, 0x39, 0x01000108), b.broadcast({0x07}), b.run(0.5); }, false,
       bit::kCommError | bit::kError},
      {"NoSupply", [](BusBench& b) { b.part->set_parameter("Supply Voltage", 0.0), b.run(0.2); }, false,
       bit::kPowVoltErr | bit::kPowerFault | bit::kError | bit::kBrakeActive},
      {"SupplyBack",
       [](BusBench& b) {
         b.part->set_parameter("Supply Voltage", 0.0), b.run(0.2),
             b.part->set_parameter("Supply Voltage", 24.0), b.run(0.2);
       },
       false, bit::kPowVoltErr | bit::kBrakeActive},
      {"PortsLost", [](BusBench& b) { b.part->controller_lost(), b.run(0.2); }, false, bit::kCommError},
  };
}

using Cell = std::tuple<std::size_t, std::size_t>;
class Matrix : public testing::TestWithParam<Cell> {};

TEST_P(Matrix, IsAnsweredAndMovesOnlyWhatMay) {
  const auto command = commands()[std::get<0>(GetParam())];
  const auto state = states()[std::get<1>(GetParam())];
  BusBench bench;
  state.enter(bench);
  ASSERT_EQ(bench.word(1) & state.bits, state.bits);
  const auto answer = bench.send(1, command.message);
  ASSERT_EQ(answer ? answer->size : 0u, command.answer);
  if (answer) {
    EXPECT_EQ(answer->data[0], command.message.data[0]);
  }
  const bool refused = command.moves && !state.takes_motion;
  if (command.moves && command.answer == 3) {
    EXPECT_EQ(answer->data[2], refused ? 0x00 : 0x64);
  }
  const double before = bench.get<float>(1, 0x3E);
  if (refused && std::string(state.name) != "Homing") {
    bench.run(0.5);
    EXPECT_NEAR(bench.get<float>(1, 0x3E), before, 0.05);  // no more than the rest of a stop
    EXPECT_EQ(bench.word(1) & (state.bits & ~bit::kBrakeActive), state.bits & ~bit::kBrakeActive);
  }
  bench.run(0.5);
  EXPECT_TRUE(std::isfinite(bench.position(1)));
  // Whatever came before, once the cause is gone the module does what it is told last.
  bench.plants[0].upper = 1e9;
  bench.part->set_parameter("Supply Voltage", 24.0);
  bench.set<std::uint32_t>(1, 0x39, 0x108u);
  bench.set(1, 0x46, 3.0f);
  bench.run(0.2);
  bench.wait_for(1, bit::kHomeOk, 5.0);
  bench.send(1, {0x00});
  bench.run(0.5);
  ASSERT_TRUE(bench.ramp(1, 0.05f));
  bench.run(6.0);
  EXPECT_NEAR(bench.position(1), 0.05, 2e-3);
}

std::string cell_name(const testing::TestParamInfo<Cell>& info) {
  return std::string(commands()[std::get<0>(info.param)].name) + "_" + states()[std::get<1>(info.param)].name;
}
INSTANTIATE_TEST_SUITE_P(PowerCube, Matrix,
                         testing::Combine(testing::Range(std::size_t{0}, commands().size()),
                                          testing::Range(std::size_t{0}, states().size())),
                         cell_name);

}  // namespace
}  // namespace visum::test
