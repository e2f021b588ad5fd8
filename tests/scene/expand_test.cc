// Expands "${...}" and `repeat` in files.
#include "protocol/config/expand.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "protocol/config/expression.h"

namespace visum::config {
namespace {

using testing::HasSubstr;

double value_of_sum(const std::string& text) {
  return evaluate(text, [](const std::string& name) {
    if (name == "row") return 3.0;
    throw std::invalid_argument("no " + name);
  });
}

std::string fault_of_sum(const std::string& text) {
  try {
    value_of_sum(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

TEST(Expression, CountsAsInSchool) {
  EXPECT_EQ(value_of_sum("1 + 2 * 3 - 4 / 2"), 5.0);
  EXPECT_EQ(value_of_sum("(1 + 2) * -(3 - 4)"), 3.0);
  EXPECT_EQ(value_of_sum("8 - 3 - 2"), 3.0);
  EXPECT_EQ(value_of_sum("--2"), 2.0);
  EXPECT_EQ(value_of_sum("1.5e-3 * row"), 1.5e-3 * 3.0);
}

TEST(Expression, TheRestHasTheSignOfTheDivisor) {
  EXPECT_EQ(value_of_sum("7 % 3"), 1.0);
  EXPECT_EQ(value_of_sum("-1 % 3"), 2.0);
}

TEST(Expression, KnowsItsFunctions) {
  EXPECT_EQ(value_of_sum("floor(7 / 2) + ceil(0.5) + round(2.6)"), 7.0);
  EXPECT_EQ(value_of_sum("min(2, row) + max(2, row) + abs(-1) + sqrt(16)"), 10.0);
  EXPECT_EQ(value_of_sum("sin(pi / 2)"), std::sin(std::numbers::pi / 2.0));
  EXPECT_EQ(value_of_sum("cos(0) + tan(0)"), 1.0);
}

TEST(Expression, SaysWhatIsNoSum) {
  EXPECT_EQ(fault_of_sum(""), "a number or a name is missing at its end");
  EXPECT_EQ(fault_of_sum("1 +"), "a number or a name is missing at its end");
  EXPECT_EQ(fault_of_sum("1 2"), "'2' is not expected");
  EXPECT_EQ(fault_of_sum("(1"), "a ')' is missing");
  EXPECT_EQ(fault_of_sum("sinus(1)"), "there is no function 'sinus'");
  EXPECT_EQ(fault_of_sum("sqr(1)"), "there is no function 'sqr'; did you mean 'sqrt'?");
  EXPECT_EQ(fault_of_sum("max(1)"), "'max' takes two numbers");
  EXPECT_EQ(fault_of_sum("1 / 0"), "it has no finite value");
  EXPECT_EQ(fault_of_sum("sqrt(-1)"), "it has no finite value");
  EXPECT_EQ(fault_of_sum("1 & 2"), "'& 2' is not expected");
  EXPECT_EQ(fault_of_sum(std::string(100, '(')), "it is nested too deep");
  EXPECT_EQ(fault_of_sum(std::string(2000, '1')), "it is longer than 1000 bytes");
}

Node expand(const std::string& yaml, const std::string& variables = "{}") {
  const Node given = load_text(variables, "given");
  Variables by_name;
  for (const std::string& name : given.keys()) by_name.emplace(name, given.get(name));
  ExpansionBudget budget;
  return expanded(load_text(yaml, "f.yaml"), by_name, budget);
}

std::string expand_error(const std::string& yaml, const std::string& variables = "{}") {
  try {
    expand(yaml, variables);
  } catch (const ConfigError& fault) {
    return fault.what();
  }
  return "no error";
}

TEST(Expand, AVariableKeepsItsKind) {
  const Node node = expand("{a: '${n}', b: '${list}', c: '${word}', d: '${flag}'}",
                           "{n: 2.5, list: [1, 2], word: red, flag: true}");
  EXPECT_EQ(node.get("a").number(), 2.5);
  EXPECT_EQ(node.get("b").numbers(2)[1], 2.0);
  EXPECT_EQ(node.get("c").text(), "red");
  EXPECT_TRUE(node.get("d").boolean());
}

TEST(Expand, WithinATextItBecomesText) {
  const Node node = expand("a: cart_${i}_of_${10 * i}\nb: $${i}\nc: cost $5", "{i: 3}");
  EXPECT_EQ(node.get("a").text(), "cart_3_of_30");
  EXPECT_EQ(node.get("b").text(), "${i}");
  EXPECT_EQ(node.get("c").text(), "cost $5");
}

TEST(Expand, NumbersAreWrittenAsTheyWouldBeRead) {
  const Node node = expand("{a: '${0.1 + 0.2}', b: '${1e20}', c: '${-3}', d: '${7 / 2}'}");
  EXPECT_EQ(node.get("a").number(), 0.1 + 0.2);
  EXPECT_EQ(node.get("b").number(), 1e20);
  EXPECT_EQ(node.get("c").integer(), -3);
  EXPECT_EQ(node.get("d").number(), 3.5);
}

TEST(Expand, RepeatsEntriesOfLists) {
  const Node node =
      expand("- name: first\n- {name: 'box_${index}', repeat: 3, x: '${2 * index}'}\n- name: last");
  ASSERT_EQ(node.size(), 5u);
  EXPECT_EQ(node.at(1).get("name").text(), "box_0");
  EXPECT_EQ(node.at(3).get("x").number(), 4.0);
  EXPECT_FALSE(node.at(3).find("repeat"));
  EXPECT_EQ(node.at(4).get("name").text(), "last");
}

TEST(Expand, RepeatsOverRowsAndColumns) {
  const Node node = expand("- {name: 'r${row}c${column}', repeat: {row: 2, column: 3}}");
  ASSERT_EQ(node.size(), 6u);
  EXPECT_EQ(node.at(0).get("name").text(), "r0c0");
  EXPECT_EQ(node.at(1).get("name").text(), "r0c1");
  EXPECT_EQ(node.at(5).get("name").text(), "r1c2");
  EXPECT_EQ(expand("- {repeat: 0}").size(), 0u);
}

TEST(Expand, ErrorsKnowLineAndNumberOfWhatIsRepeated) {
  const Node node = expand("a:\n- {repeat: 2, x: 1}\n- {x: two}");
  const auto place = [&](std::size_t item) { return node.get("a").at(item).get("x").place(); };
  EXPECT_EQ(place(1).key, "a[0, index 1].x");
  EXPECT_EQ(place(1).line, 2);
  EXPECT_EQ(place(2).key, "a[1].x");
  EXPECT_EQ(place(2).line, 3);
}

TEST(Expand, RefusesWhatMakesNoSense) {
  EXPECT_EQ(expand_error("a: 1\nb: ${widht}", "{width: 1}"),
            "f.yaml:2: b: there is no parameter 'widht'; did you mean 'width'?");
  EXPECT_EQ(expand_error("a: ${1 +}"), "f.yaml:1: a: '${1 +}': a number or a name is missing at its end");
  EXPECT_EQ(expand_error("a: ${1"), "f.yaml:1: a: '${1' has no '}'");
  EXPECT_EQ(expand_error("a: ${2 * word}", "{word: red}"), "f.yaml:1: a: 'word' is no number");
  EXPECT_EQ(expand_error("a: b${list}", "{list: []}"),
            "f.yaml:1: a: 'list' is a list or a map, and no text may stand beside it");
  EXPECT_EQ(expand_error("'${a}': 1", "{a: 1}"), "f.yaml:1: a key cannot be computed");
  EXPECT_THAT(expand_error("- {repeat: many}"), HasSubstr("[0].repeat: must be a whole number, is 'many'"));
  EXPECT_THAT(expand_error("- {repeat: -1}"),
              HasSubstr("[0].repeat: must be a whole number between 0 and 10000, is -1"));
  EXPECT_THAT(expand_error("- {repeat: []}"),
              HasSubstr("[0].repeat: must be a number, or a map of 1 to 3 names to numbers"));
  EXPECT_THAT(expand_error("- {repeat: {pi: 3}}"),
              HasSubstr("[0].repeat: 'pi' is the name of a function or number"));
}

TEST(Expand, NothingGrowsWithoutBound) {
  EXPECT_THAT(expand_error("- {repeat: {i: 5000, j: 5000}}"),
              HasSubstr("must be at most 10000 in all, is 25000000"));
  EXPECT_THAT(expand_error("- repeat: 10000\n  a:\n  - {repeat: 10000}"),
              HasSubstr("more than 1000000 values"));
  std::string text = "x";
  for (int i = 0; i < 12; ++i) text += text;
  EXPECT_EQ(expand_error("a: '${t}${t}${t}${t}${t}${t}${t}${t}${t}${t}${t}${t}${t}${t}${t}${t}${t}'",
                         "{t: " + text + "}"),
            "f.yaml:1: a: a computed text is too long");
}

}  // namespace
}  // namespace visum::config
