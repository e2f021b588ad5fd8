#include "clients/visum/run/sweep.h"

#include <gmock/gmock.h>

#include "clients/visum/run/scenario_reader.h"
#include "protocol/config/flow.h"

namespace visum::run {
namespace {

using ::testing::ElementsAre;

const std::string kHead =
    "visum_scenario: 1\nname: n\nscene: models/scenes/amtec_arm.yaml\nuntil: {at_s: 1}\n";

config::Node scenario(const std::string& more) {
  return config::load_text(kHead + more, "s.yaml", VISUM_SOURCE_DIR);
}

std::vector<std::string> texts(const std::string& more, std::size_t axis = 0) {
  const Sweep sweep(scenario(more));
  std::vector<std::string> texts;
  for (std::size_t run = 1; run <= sweep.runs(); ++run)
    texts.push_back(sweep.point(run).described.at(axis).second);
  return texts;
}

std::string error_of(const std::string& more, std::size_t run = 1) {
  try {
    read_scenario(scenario(more), run);
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "nothing was wrong";
}

TEST(Sweep, AScenarioWithoutOneIsOneRun) {
  const Sweep sweep(scenario(""));
  EXPECT_FALSE(sweep.given());
  EXPECT_EQ(sweep.runs(), 1u);
  EXPECT_EQ(read_scenario(scenario("")).run, 0u);
}

TEST(Sweep, IsTheProductWithTheLastNameFastest) {
  const std::string text = "sweep: {a: [1, 2], b: [x, y, z]}\n";
  EXPECT_THAT(texts(text, 0), ElementsAre("1", "1", "1", "2", "2", "2"));
  EXPECT_THAT(texts(text, 1), ElementsAre("x", "y", "z", "x", "y", "z"));
}

TEST(Sweep, ARangeHasBothItsEnds) {
  EXPECT_THAT(texts("sweep: {a: {from: 3, to: 5}}\n"), ElementsAre("3", "4", "5"));
  EXPECT_THAT(texts("sweep: {a: {from: 0, to: 0.3, step: 0.1}}\n"), ElementsAre("0", "0.1", "0.2", "0.3"));
  EXPECT_THAT(texts("sweep: {a: {from: -1, to: 1, count: 5}}\n"), ElementsAre("-1", "-0.5", "0", "0.5", "1"));
  EXPECT_THAT(texts("sweep: {a: {from: 1, to: 2.5}}\n"), ElementsAre("1", "2"));
}

TEST(Sweep, ItsValuesStandInTheRestOfTheFile) {
  const std::string text =
      "seed: ${seed}\nsweep: {seed: [3, 4], mass: [0.5]}\nparameters: {box_mass: \"${mass}\"}\n"
      "timeline: [{at_s: \"${seed / 2}\", say: \"seed ${seed}\"}]\n";
  const Scenario second = read_scenario(scenario(text), 2);
  EXPECT_EQ(second.seed, 4);
  EXPECT_EQ(second.parameters, "{box_mass: 0.5}");
  EXPECT_EQ(second.timeline.at(0).at_s, 2.0);
  EXPECT_EQ(std::get<Say>(second.timeline.at(0).action).text, "seed 4");
  EXPECT_EQ(second.run, 2u);
  EXPECT_THAT(second.swept, ElementsAre(std::pair<std::string, std::string>("seed", "4"),
                                        std::pair<std::string, std::string>("mass", "0.5")));
}

TEST(Sweep, AValueMayBeAWholeEntry) {
  const std::string text =
      "sweep: {fault: [{say: none}, {fault: {part: arm, kind: torque_lost, numbers: {joint: 2}}}]}\n"
      "timeline: [{at_s: 0, say: first}]\n";
  const Sweep sweep(scenario(text));
  EXPECT_EQ(sweep.point(2).described.at(0).second,
            "{fault: {part: arm, kind: torque_lost, numbers: {joint: 2}}}");
  const std::string whole =
      "sweep: {entry: [{at_s: 0, say: none}, {at_s: 1, fault: {part: arm, kind: torque_lost}}]}\n"
      "timeline: [\"${entry}\"]\n";
  EXPECT_TRUE(std::holds_alternative<Say>(read_scenario(scenario(whole), 1).timeline.at(0).action));
  EXPECT_TRUE(std::holds_alternative<InjectFault>(read_scenario(scenario(whole), 2).timeline.at(0).action));
}

TEST(Sweep, EntriesMayBeRepeated) {
  const Scenario three = read_scenario(scenario("timeline: [{repeat: 3, at_s: \"${index}\", say: so}]\n"));
  ASSERT_EQ(three.timeline.size(), 3u);
  EXPECT_EQ(three.timeline[2].at_s, 2.0);
}

TEST(Sweep, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(error_of("sweep: [1]\n"),
            "s.yaml:5: sweep: must be a map of names to values: {seed: {from: 1, to: 10}, payload: [1, 2]}");
  EXPECT_EQ(error_of("sweep: {a: 1}\n"), "s.yaml:5: sweep.a: must be a list of values, or {from: 1, to: 10}");
  EXPECT_EQ(error_of("sweep: {a: []}\n"),
            "s.yaml:5: sweep.a: must be a list of values, or {from: 1, to: 10}");
  EXPECT_EQ(error_of("sweep: {a: {from: 2, to: 1}}\n"),
            "s.yaml:5: sweep.a: 'to' must not be less than 'from'");
  EXPECT_EQ(error_of("sweep: {a: {from: 1, to: 2, step: 0}}\n"),
            "s.yaml:5: sweep.a.step: must be greater than 0, is 0");
  EXPECT_EQ(error_of("sweep: {a: {from: 1, to: 1e10}}\n"),
            "s.yaml:5: sweep.a: gives more than 1000000000 runs");
  EXPECT_EQ(error_of("sweep: {a: {from: 1, to: 100001}, b: {from: 1, to: 10000}}\n"),
            "s.yaml:5: sweep: gives more than 1000000000 runs");
  EXPECT_EQ(error_of("sweep: {pi: [1]}\n"), "s.yaml:5: sweep.pi: 'pi' is the name of a function or number");
  EXPECT_EQ(error_of("sweep: {seed: [1, x]}\nseed: ${seed}\n", 2),
            "s.yaml:6: seed: must be a whole number, is 'x'");
  EXPECT_EQ(error_of("sweep: {payload: [1]}\nseed: ${paylod}\n"),
            "s.yaml:6: seed: there is no parameter 'paylod'; did you mean 'payload'?");
  EXPECT_EQ(error_of("parameters: [1]\n"), "s.yaml:5: parameters: must be a map of the scene's parameters");
}

TEST(Flow, ReadsBackAsTheSame) {
  for (const std::string text :
       {"{a: 1, b: \"1\", c: [true, \"x y\", null], \"d: e\": \"{#}\"}", "\"line\\x0aline \\\"quoted\\\"\"",
        "[]", "-0.5", "{}", "{\"null\": \"NULL\", \"Null\": -.inf}", "[.5, -.5, +5, 1e+3, .nan]"}) {
    const auto node = config::load_text(text, "t");
    EXPECT_EQ(config::flow(node), text);
    EXPECT_EQ(config::flow(config::load_text(config::flow(node), "t")), text);
  }
}

}  // namespace
}  // namespace visum::run
