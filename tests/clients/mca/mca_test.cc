// Modules, groups and edges in MCA2's manner, without a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "clients/mca/announce.h"
#include "clients/mca/part.h"
#include "protocol/config/config.h"
#include "protocol/module_board.h"
#include "protocol/part_description.h"

namespace visum::mca {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <typename Call>
std::string refusal_of(Call call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "done";
}

TEST(Names, AreThoseThatToolsShow) {
  EXPECT_EQ(natural_name("eCI_DESIRED_ANGLE_1"), "Desired Angle 1");
  EXPECT_EQ(natural_name("eSO_X"), "X");
  EXPECT_THAT(port_names("eCI_A,\n  eCI_B_2 , eCI_DIMENSION"), ElementsAre("A", "B 2"));
  EXPECT_THAT(port_names("eCI_DIMENSION"), IsEmpty());
  EXPECT_THAT(refusal_of([] { natural_name("DESIRED"); }), HasSubstr("has no prefix"));
  EXPECT_THAT(refusal_of([] { port_names("eCI_A = 3, eCI_DIMENSION"); }), HasSubstr("has a value"));
  EXPECT_THAT(refusal_of([] { port_names("eCI_A, eCI_B"); }), HasSubstr("must end with _DIMENSION"));
}

// Adds a step to what comes down and doubles what comes up, and notes when it was called.
class Step : public Module {
 public:
  MCA_CONTROLLER_INPUT(eCI_VALUE, eCI_RESET, eCI_DIMENSION);
  MCA_CONTROLLER_OUTPUT(eCO_VALUE, eCO_RESET, eCO_DIMENSION);
  MCA_SENSOR_INPUT(eSI_VALUE, eSI_DIMENSION);
  MCA_SENSOR_OUTPUT(eSO_VALUE, eSO_DIMENSION);
  Step(Place place, std::vector<std::string>& calls) : Module(place, ports<Step>()), calls_(calls) {}
  void Control() override {
    calls_.push_back("control " + name());
    ControllerOutput(eCO_VALUE) = ControllerInput(eCI_VALUE) + step();
    ControllerOutput(eCO_RESET) = ControllerInput(eCI_RESET);
    resets += ControllerInputChanged(eCI_RESET) ? 1 : 0;
    changes += ControllerInputChanged() ? 1 : 0;
    parameter_changes += ParametersChanged() ? 1 : 0;
  }
  void Sense() override {
    calls_.push_back("sense " + name());
    SensorOutput(eSO_VALUE) = 2.0 * SensorInput(eSI_VALUE);
  }
  int resets = 0, changes = 0, parameter_changes = 0;
  Parameter<double> step{*this, "Step", 1.0, {.minimum = 0.0, .maximum = 9.0}};
  Parameter<std::string> mode{*this, "Mode", "slow", {.choices = {"slow", "fast"}}};

 private:
  std::vector<std::string>& calls_;
};

// A part with two steps, one above the other. The lower one is added first.
class Two : public Part {
 public:
  MCA_CONTROLLER_INPUT(eCI_VALUE, eCI_RESET, eCI_DIMENSION);
  MCA_CONTROLLER_OUTPUT(eCO_VALUE, eCO_RESET, eCO_DIMENSION);
  MCA_SENSOR_INPUT(eSI_VALUE, eSI_DIMENSION);
  MCA_SENSOR_OUTPUT(eSO_VALUE, eSO_DIMENSION);
  Two() : Part("two", ports<Two>()), lower(add<Step>("Lower", calls)), upper(add<Step>("Upper", calls)) {
    AddEdge(controller_input(), upper.controller_input());
    AddEdge(upper.controller_output(), lower.controller_input());
    AddEdge(lower.controller_output(), controller_output());
    AddEdge(sensor_input(), lower.sensor_input());
    AddEdge(lower.sensor_output(), upper.sensor_input());
    AddEdge(upper.sensor_output(), sensor_output());
    std::vector<std::string> complaints;
    sort(complaints);
    EXPECT_THAT(complaints, IsEmpty());
  }
  void cycle() {
    run_sense();
    run_control();
  }
  std::vector<std::string> calls;
  Step &lower, &upper;
};

TEST(Group, SensesUpwardsThenControlsDownwards) {
  Two two;
  two.controller_input().at(Two::eCI_VALUE) = 10.0;
  two.sensor_input().at(Two::eSI_VALUE) = 3.0;
  two.cycle();
  EXPECT_THAT(two.calls, ElementsAre("sense Lower", "sense Upper", "control Upper", "control Lower"));
  EXPECT_EQ(two.controller_output().at(Two::eCO_VALUE), 12.0);
  EXPECT_EQ(two.sensor_output().at(Two::eSO_VALUE), 12.0);
}

TEST(Module, SeesWhatHasChanged) {
  Two two;
  for (int i = 0; i < 3; ++i) two.cycle();
  EXPECT_EQ(two.upper.changes, 1);  // the first call sees everything
  two.controller_input().at(Two::eCI_VALUE) = 5.0;
  two.cycle();
  EXPECT_EQ(two.upper.changes, 2);
  EXPECT_EQ(two.upper.resets, 1);
  two.controller_input().at(Two::eCI_RESET) += 1.0;
  two.cycle();
  two.cycle();
  EXPECT_EQ(two.lower.resets, 2);
}

TEST(Group, LeavesMembersOfACycleOut) {
  std::vector<std::string> calls, complaints;
  Part loop("loop", {});
  auto& a = loop.add<Step>("A", calls);
  auto& b = loop.add<Step>("B", calls);
  loop.add<Step>("C", calls);
  loop.AddEdge(a.controller_output(), b.controller_input());
  loop.AddEdge(b.controller_output(), a.controller_input());
  loop.sort(complaints);
  EXPECT_THAT(complaints, ElementsAre(HasSubstr("'A' is left out of the control"), HasSubstr("'B'")));
  loop.run_control();
  EXPECT_THAT(calls, ElementsAre("control C"));
}

TEST(Edges, CarryPartsOfVectorsAndLeaveOneOutputSeveralTimes) {
  Two two;
  Two other;
  two.AddEdge(two.upper.controller_output(), Step::eCO_VALUE, two.controller_output(), Two::eCO_RESET, 1);
  two.controller_input().at(Two::eCI_VALUE) = 10.0;
  two.cycle();
  EXPECT_EQ(two.controller_output().at(Two::eCO_VALUE), 12.0);
  EXPECT_EQ(two.controller_output().at(Two::eCO_RESET), 11.0);
  const auto refusal = [&](Vector& from, Vector& to) { return refusal_of([&] { two.AddEdge(from, to); }); };
  EXPECT_THAT(refusal(two.upper.sensor_output(), two.lower.controller_input()), HasSubstr("1 and 2 ports"));
  EXPECT_THAT(refusal(two.upper.controller_input(), two.lower.controller_input()),
              HasSubstr("must begin at"));
  EXPECT_THAT(refusal(other.upper.controller_output(), two.lower.controller_input()),
              HasSubstr("must begin at an output of a member"));
  EXPECT_THAT(
      refusal_of([&] { two.AddEdge(two.upper.controller_output(), 1, two.lower.controller_input(), 1, 2); }),
      HasSubstr("beyond the vector"));
}

TEST(Overrides, HoldAgainstTheEdgeUntilTheyAreReleased) {
  Two two;
  two.sensor_input().at(Two::eSI_VALUE) = 3.0;
  two.upper.sensor_input().hold(Step::eSI_VALUE, 100.0);
  two.cycle();
  EXPECT_EQ(two.sensor_output().at(Two::eSO_VALUE), 200.0);
  EXPECT_THAT(values_of(two).modules.at(2).overridden, ElementsAre(0u));
  two.upper.sensor_input().release(Step::eSI_VALUE);
  two.cycle();
  EXPECT_EQ(two.sensor_output().at(Two::eSO_VALUE), 12.0);
  EXPECT_THAT(values_of(two).modules.at(2).overridden, IsEmpty());
}

TEST(Parameters, AreCheckedAndNoticed) {
  Two two;
  two.cycle();
  EXPECT_EQ(two.upper.step.set(std::int64_t{2}), "");
  EXPECT_EQ(two.upper.step(), 2.0);
  EXPECT_EQ(two.upper.step.set(10.0), "'Step' must be within 0 and 9");
  EXPECT_EQ(two.upper.step.set(true), "'Step' is a number");
  EXPECT_EQ(two.upper.mode.set(std::string("fats")), "'Mode' must be one of: slow, fast");
  EXPECT_EQ(two.upper.step.description().name, "Upper Step");
  two.cycle();
  two.cycle();
  EXPECT_EQ(two.upper.parameter_changes, 2);
}

TEST(ConfigFile, SetsParametersByModule) {
  const std::string file = ::testing::TempDir() + "mca_test.yaml";
  const auto apply = [&](const std::string& text) {
    std::ofstream(file) << text;
    Two two;
    return refusal_of([&] {
      apply_config_file(file, two);
      EXPECT_EQ(two.upper.step(), 4.0);
    });
  };
  EXPECT_EQ(apply("Upper: {Step: 4, Mode: fast}\n"), "done");
  EXPECT_THAT(apply("Uper: {Step: 4}\n"), HasSubstr("there is no module 'Uper'; did you mean 'Upper'?"));
  EXPECT_THAT(apply("Upper: {Stop: 4}\n"), HasSubstr("there is no parameter 'Stop'; did you mean 'Step'?"));
  EXPECT_THAT(apply("Upper:\n  Step: 40\n"), HasSubstr(":2: Upper.Step: 'Step' must be within 0 and 9"));
}

TEST(Options, ReadPeriodsWithTheirUnit) {
  EXPECT_EQ(period_of("10ms"), 10'000'000);
  EXPECT_EQ(period_of("0.005s"), 5'000'000);
  EXPECT_EQ(period_of("250us"), 250'000);
  EXPECT_EQ(period_of("250\u00b5s"), 250'000);
  for (const auto* bad : {"10", "ms", "-1ms", "0s", "1e99s", "nans", "10 ms", "10min"})
    EXPECT_THAT(refusal_of([&] { period_of(bad); }), HasSubstr("is no period")) << bad;
}

TEST(Announcement, NamesModulesGroupsAndEdges) {
  Two two;
  const auto announced = describe(two, {}, "127.0.0.1:1234");
  ASSERT_EQ(announced.modules.size(), 3u);
  EXPECT_TRUE(announced.modules[0].is_group);
  EXPECT_EQ(announced.modules[0].path, "");
  EXPECT_EQ(announced.modules[1].path, "Lower");
  EXPECT_THAT(announced.modules[1].controller_inputs, ElementsAre("Value", "Reset"));
  ASSERT_EQ(announced.edges.size(), 6u);
  EXPECT_EQ(announced.edges[1].from.path, "Upper");
  EXPECT_EQ(announced.edges[1].to.vector, VectorKind::kControllerInput);
}

TEST(Announcement, HasParametersByModuleWithTheirValues) {
  Two two;
  const auto announced = describe(two, {}, "");
  const auto& step = announced.modules[2].parameters.at(0);
  EXPECT_EQ(step.name, "Step");
  EXPECT_EQ(step.maximum, 9.0);
  EXPECT_THAT(announced.modules[2].parameters.at(1).choices, ElementsAre("slow", "fast"));
  EXPECT_EQ(two.upper.step.set(3.0), "");
  EXPECT_EQ(values_of(two).modules.at(2).parameters.at(0), ParameterValue(3.0));
  EXPECT_EQ(values_of(two).modules.at(1).parameters.at(0), ParameterValue(1.0));
  EXPECT_EQ(protocol::ModuleBoard::check(announced), std::nullopt);
}

std::vector<std::byte> bytes(std::size_t count, int value = 1) {
  return std::vector<std::byte>(count, std::byte(value));
}

TEST(Blackboards, BelongToThePartAndAreWrittenWholeOrByOffset) {
  Two two;
  Blackboard way(two.upper, "Way", {.content_type = "application/x-float32", .row_bytes = 4, .most_rows = 3});
  EXPECT_EQ(way.write(bytes(8)), "");
  EXPECT_EQ(way.write(bytes(8, 2), 4), "");
  EXPECT_EQ(way.rows(), 3u);
  EXPECT_EQ(way.bytes()[3], std::byte(1));
  EXPECT_EQ(way.bytes()[4], std::byte(2));
  EXPECT_EQ(way.generation(), 2u);
  EXPECT_EQ(way.write(bytes(4), 13), "'Way' has 12 bytes, and a write cannot begin behind them");
  EXPECT_EQ(way.write(bytes(8), 8), "'Way' takes at most 12 bytes");
  EXPECT_EQ(way.write(bytes(6)), "'Way' has rows of 4 bytes");
  EXPECT_EQ(way.generation(), 2u);
  EXPECT_THAT(two.blackboards(), ElementsAre(&way));
  EXPECT_THAT(refusal_of([&] { Blackboard(two.lower, "Way"); }), HasSubstr("has two blackboards 'Way'"));
  EXPECT_THAT(refusal_of([&] { Blackboard(two, "Big", {.row_bytes = 1u << 20, .most_rows = 17}); }),
              HasSubstr("more than 16777216 bytes"));
  const auto announced = describe(two, {}, "");
  EXPECT_EQ(announced.blackboards.at(0).capacity, 12u);
  EXPECT_EQ(values_of(two).blackboards.at(0).elements, 3u);
  EXPECT_EQ(values_of(two).blackboards.at(0).head.size(), 12u);
}

}  // namespace
}  // namespace visum::mca
