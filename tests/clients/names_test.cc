// Ports and parameters by what a user types, and what he is told where it is wrong.
#include <gmock/gmock.h>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/parameters.h"
#include "clients/visum/common/ports.h"
#include "clients/visum/common/samples.h"

namespace visum::cli {
namespace {

using protocol::PartDescription;

PartDescription arm() {
  PartDescription part;
  part.name = "arm";
  part.controller_inputs = {{"Desired Angle 1", "rad", -6, 6, 0, "Desired Angle"},
                            {"Desired Angle 2", "rad", -6, 6, 0, "Desired Angle"},
                            {"Reset", "", 0, 1e6, 0, ""}};
  part.sensor_outputs = {{"Actual Angle 1", "rad", -7, 7, 0, "Actual Angle"},
                         {"Part State", "", 0, 8, 0, ""}};
  return part;
}

template <typename Action>
std::string usage_error_of(Action action) {
  try {
    action();
  } catch (const ExitError& error) {
    EXPECT_EQ(error.code(), kUsage);
    return error.what();
  }
  return "nothing was refused";
}

TEST(Ports, NoNameIsAllOutputsThenAllInputs) {
  const auto part = arm();
  const auto ports = find_ports(part, {});
  ASSERT_EQ(ports.size(), 5u);
  EXPECT_EQ(ports.front().port->name, "Actual Angle 1");
  EXPECT_TRUE(ports.front().output);
  EXPECT_EQ(ports.back().port->name, "Reset");
  EXPECT_EQ(ports.back().index, 2u);
}

TEST(Ports, AGroupIsAllOfIt) {
  EXPECT_EQ(find_ports(arm(), {"Desired Angle"}).size(), 2u);
}

TEST(Ports, AnUnknownNameIsToldWithTheNearest) {
  EXPECT_EQ(usage_error_of([] { find_ports(arm(), {"Actual Angel 1"}); }),
            "part 'arm' has no port 'Actual Angel 1'; did you mean 'Actual Angle 1'?");
  EXPECT_EQ(usage_error_of([] { find_input(arm(), "Desired Angel 2"); }),
            "part 'arm' has no controller input 'Desired Angel 2'; did you mean 'Desired Angle 2'?");
}

TEST(Ports, AnOutputCannotBeSet) {
  EXPECT_EQ(usage_error_of([] { find_input(arm(), "Part State"); }),
            "'Part State' is a sensor output of part 'arm'; it can only be read");
}

TEST(Ports, AValueIsANumberInItsRange) {
  const auto part = arm();
  const auto& port = part.controller_inputs[0];
  EXPECT_EQ(read_value(part, port, "-0.5"), -0.5);
  EXPECT_EQ(read_value(part, port, "+1e-3"), 1e-3);
  for (const char* bad : {"", "abc", "1x", "nan", "inf", "6.1", "1e999", " 1", "0x10", "+", "--1"}) {
    EXPECT_EQ(usage_error_of([&] { read_value(part, port, bad); }),
              "port 'Desired Angle 1' of part 'arm' takes -6 .. 6 rad, not '" + std::string(bad) + "'");
  }
}

TEST(Parameters, AValueHasTheParametersOwnType) {
  using protocol::ParameterValue;
  EXPECT_EQ(parse_value({"k", "", "", 1.0, 0, 0, {}, false}, "2"), ParameterValue(2.0));
  EXPECT_EQ(parse_value({"n", "", "", std::int64_t{1}, 0, 0, {}, false}, "2"),
            ParameterValue(std::int64_t{2}));
  EXPECT_EQ(parse_value({"b", "", "", true, 0, 0, {}, false}, "false"), ParameterValue(false));
  EXPECT_EQ(parse_value({"s", "", "", std::string("x"), 0, 0, {}, false}, "2"),
            ParameterValue(std::string("2")));
  EXPECT_EQ(usage_error_of([] {
              parse_value({"n", "", "", std::int64_t{1}, 1, 5, {}, false}, "2.5");
            }),
            "parameter 'n' takes 1 .. 5, not '2.5'");
  EXPECT_EQ(usage_error_of([] {
              parse_value({"b", "", "", true, 0, 0, {}, false}, "maybe");
            }),
            "parameter 'b' takes flag, not 'maybe'");
}

TEST(Samples, TextAndJsonShowTheSameValues) {
  const auto part = arm();
  const auto ports = find_ports(part, {"Actual Angle 1", "Part State"});
  const protocol::PartSample sample{"arm", 7, 7'000'000, 1, {0, 0, 0}, {0.5, 16777217.0}, 0};
  EXPECT_EQ(
      sample_json(sample, ports),
      R"({"part":"arm","tick":7,"sim_time_ns":7000000,"era":1,"ports":{"Actual Angle 1":0.5,"Part State":16777217}})");
  EXPECT_EQ(sample_line(sample, ports), "0.007 s  Actual Angle 1=0.5 rad  Part State=16777217");
  EXPECT_THAT(sample_table(sample, ports), ::testing::HasSubstr("16777217"))
      << "a state word keeps all its bits";
}

TEST(Samples, AShortSampleIsAnErrorNotACrash) {
  const auto part = arm();
  const auto ports = find_ports(part, {});
  EXPECT_THROW(sample_json({"arm", 0, 0, 0, {}, {}, 0}, ports), ExitError);
}

}  // namespace
}  // namespace visum::cli
