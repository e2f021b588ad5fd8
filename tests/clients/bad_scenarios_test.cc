// A wrong scenario is refused with file, line, key and reason, compared word for word.
#include <gtest/gtest.h>

#include "clients/visum/run/scenario_reader.h"

namespace visum::run {
namespace {

constexpr const char* kHead = "visum_scenario: 1\nname: n\nscene: models/scenes/amtec_arm.yaml\n";

std::string error_of(const std::string& yaml) {
  try {
    read_scenario(config::load_text(yaml, "s.yaml", VISUM_SOURCE_DIR));
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "nothing was wrong";
}

struct Wrong {
  const char* yaml;  // after kHead
  const char* message;
};

std::ostream& operator<<(std::ostream& to, const Wrong& wrong) {
  return to << wrong.yaml;
}

class BadScenario : public ::testing::TestWithParam<Wrong> {};

TEST_P(BadScenario, IsToldWhatIsWrong) {
  const std::string text = std::string(kHead) + GetParam().yaml;
  EXPECT_EQ(error_of(text), GetParam().message) << text;
}

INSTANTIATE_TEST_SUITE_P(
    Basics, BadScenario,
    ::testing::Values(
        Wrong{"untill: {at_s: 1}\n", "s.yaml:4: unknown key 'untill'; did you mean 'until'?"},
        Wrong{"clock: lockstp\nuntil: {at_s: 1}\n",
              "s.yaml:4: clock: must be one of realtime, lockstep, free, is 'lockstp'; did you "
              "mean 'lockstep'?"},
        Wrong{"seed: -1\nuntil: {at_s: 1}\n",
              "s.yaml:4: seed: must be a whole number between 0 and 9223372036854775807, is -1"},
        Wrong{"max_sim_s: 0\nuntil: {at_s: 1}\n",
              "s.yaml:4: max_sim_s: must be greater than 0 and at most 1e+07, is 0"},
        Wrong{"max_sim_s: soon\nuntil: {at_s: 1}\n", "s.yaml:4: max_sim_s: must be a number, is 'soon'"},
        Wrong{"check_every_ms: 5000\nuntil: {at_s: 1}\n",
              "s.yaml:4: check_every_ms: must be greater than 0 and at most 4000, is 5000"},
        Wrong{"",
              "s.yaml:1: without controllers, 'until' must say when the scenario ends: {at_s: "
              "5}, or a condition"},
        Wrong{"until: never\n", "s.yaml:4: until: must be controllers, {at_s: 5} or a condition"},
        Wrong{"until: {at_s: 1, below: 3}\n", "s.yaml:4: until: unknown key 'below'"},
        Wrong{"until: controllers\n",
              "s.yaml:4: until: without controllers, 'until' must say when the scenario ends: "
              "{at_s: 5}, or a condition"},
        Wrong{"until: {below: 3}\n", "s.yaml:4: until: names no quantity"}));

INSTANTIATE_TEST_SUITE_P(
    Controllers, BadScenario,
    ::testing::Values(
        Wrong{"controllers: {name: a}\n", "s.yaml:4: controllers: must be a list"},
        Wrong{"controllers: [a]\n", "s.yaml:4: controllers[0]: must be a map"},
        Wrong{"controllers: [{command: [a]}]\n", "s.yaml:4: controllers[0]: key 'name' is missing"},
        Wrong{"controllers: [{name: a}]\n", "s.yaml:4: controllers[0]: key 'command' is missing"},
        Wrong{"controllers: [{name: a, command: ./a}]\n",
              "s.yaml:4: controllers[0].command: must be a list: the program, then its arguments"},
        Wrong{"controllers: [{name: a, command: []}]\n",
              "s.yaml:4: controllers[0].command: must be a list: the program, then its arguments"},
        Wrong{"controllers: [{name: a, command: [a, '{prt}']}]\n",
              "s.yaml:4: controllers[0].command[1]: there is no placeholder 'prt'; did you mean 'port'?"},
        Wrong{"controllers: [{name: scenario, command: [a]}]\n",
              "s.yaml:4: controllers[0]: the client name 'scenario' is the runner's own"},
        Wrong{"controllers: [{name: a, command: [a]}, {name: a, command: [b]}]\n",
              "s.yaml:4: controllers[1]: a second controller 'a'"},
        Wrong{"controllers: [{name: bridge, command: [a]}, {name: b, command: [b], through: brigde}]\n",
              "s.yaml:4: controllers[1].through: there is no other controller 'brigde'; did you mean "
              "'bridge'?"},
        Wrong{
            "controllers: [{name: a, command: [a], exchanges: false}, {name: b, command: [b], through: a}]\n",
            "s.yaml:4: controllers[1].through: 'a' must exchange something itself"},
        Wrong{"controllers: [{name: a, command: [a], exchanges: false, through: a}]\n",
              "s.yaml:4: controllers[0].through: not with 'exchanges: false'"},
        Wrong{"controllers: [{name: a, command: [a], client: c}, {name: b, command: [b], client: c}]\n",
              "s.yaml:4: controllers[1]: a second controller with client 'c'"}));

INSTANTIATE_TEST_SUITE_P(
    Timeline, BadScenario,
    ::testing::Values(Wrong{"until: {at_s: 1}\ntimeline: [{say: x}]\n",
                            "s.yaml:5: timeline[0]: needs either 'at_s' or 'when'"},
                      Wrong{"until: {at_s: 1}\ntimeline: [{at_s: 1}]\n",
                            "s.yaml:5: timeline[0]: needs exactly one of set, push, parameter, fault, "
                            "clear_fault, kill, signal, "
                            "remove_body, say"},
                      Wrong{"until: {at_s: 1}\ntimeline: [{at_s: 1, say: x, remove_body: b}]\n",
                            "s.yaml:5: timeline[0]: needs exactly one of set, push, parameter, fault, "
                            "clear_fault, kill, signal, "
                            "remove_body, say"},
                      Wrong{"until: {at_s: 1}\ntimeline: [{at_s: 1, kill: x}]\n",
                            "s.yaml:5: timeline[0].kill: there is no controller 'x'"},
                      Wrong{"until: {at_s: 1}\ntimeline: [{at_s: -1, say: x}]\n",
                            "s.yaml:5: timeline[0].at_s: must be at least 0, is -1"},
                      Wrong{"until: {at_s: 1}\ntimeline: [{at_s: 1, push: {body: b, force_n: [1, 2]}}]\n",
                            "s.yaml:5: timeline[0].push.force_n: must be a list of 3 numbers, has 2"},
                      Wrong{"until: {at_s: 1}\ntimeline: [{at_s: 1, set: {part: p, port: q}}]\n",
                            "s.yaml:5: timeline[0].set: key 'value' is missing"}));

INSTANTIATE_TEST_SUITE_P(
    Checks, BadScenario,
    ::testing::Values(
        Wrong{"until: {at_s: 1}\nchecks: [{name: x}]\n", "s.yaml:5: checks[0]: key 'that' is missing"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {spede: {body: box}, below: 1}}]\n",
              "s.yaml:5: checks[0].that.spede: there is no quantity 'spede'; did you mean 'speed'?"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: box}}}]\n",
              "s.yaml:5: checks[0].that: needs a bound: below, above, between or equals"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: box}, tilt: {body: box}, below: 1}}]\n",
              "s.yaml:5: checks[0].that.tilt: a condition has one quantity; this is the second"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: box, below: 1}}]\n",
              "s.yaml:5: checks[0].that.speed: must be a map, as {body: box}"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: box, axis: z}, below: 1}}]\n",
              "s.yaml:5: checks[0].that.speed: unknown key 'axis'"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: box}, between: [2, 1]}}]\n",
              "s.yaml:5: checks[0].that.between: the first number must not be greater than the second"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: box}, below: 1, within: 1}}]\n",
              "s.yaml:5: checks[0].that.within: belongs to 'equals'"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: box}, below: .nan}}]\n",
              "s.yaml:5: checks[0].that.below: must be a finite number, is .nan"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {peak_following_error: {}, below: 1}}]\n",
              "s.yaml:5: checks[0].that.peak_following_error: needs either 'part' or 'joint'"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: b}, below: 1}, when: sometimes}]\n",
              "s.yaml:5: checks[0].when: must be one of end, always, eventually, is 'sometimes'"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: b}, below: 1}, when: [1]}]\n",
              "s.yaml:5: checks[0].when: must be end, always, eventually, {from_s:, to_s:} or {by_s:}"},
        Wrong{"until: {at_s: 1}\nchecks: [{that: {speed: {body: b}, below: 1}, when: {by_s: 1, to_s: 2}}]\n",
              "s.yaml:5: checks[0].when: 'by_s' stands alone"},
        Wrong{
            "until: {at_s: 1}\nchecks: [{that: {speed: {body: b}, below: 1}, when: {from_s: 3, to_s: 2}}]\n",
            "s.yaml:5: checks[0].when: 'from_s' must not be later than 'to_s'"}));

TEST(BadScenarioHead, VersionNameAndSceneAreNeeded) {
  EXPECT_EQ(error_of("name: n\n"), "s.yaml:1: key 'visum_scenario' is missing");
  EXPECT_EQ(error_of("{visum_scenario: 2, name: n}"),
            "s.yaml:1: visum_scenario: this program reads version 1");
  EXPECT_EQ(error_of("{visum_scenario: 1, scene: x}"), "s.yaml:1: key 'name' is missing");
  EXPECT_EQ(error_of("{visum_scenario: 1, name: n, scene: nowhere.yaml}"),
            "s.yaml:1: scene: there is no file '" VISUM_SOURCE_DIR "/nowhere.yaml'");
  const std::string long_name(300, 'a');
  EXPECT_EQ(error_of("{visum_scenario: 1, name: n, scene: " + long_name + "}"),
            "s.yaml:1: scene: '" VISUM_SOURCE_DIR "/" + long_name + "' cannot be read: File name too long");
  EXPECT_EQ(error_of("[1, 2]"), "s.yaml:1: a scenario is a map");
}

}  // namespace
}  // namespace visum::run
