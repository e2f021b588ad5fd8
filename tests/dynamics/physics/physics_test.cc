// Runs every case with every engine row that it is for, against expectations.cc.
#include <gtest/gtest.h>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/expectations.h"

#ifndef VISUM_PHYSICS_LONG
#define VISUM_PHYSICS_LONG false
#endif

namespace visum::physics {
namespace {

struct Run {
  const Case* what;
  const EngineRow* row;
  const Expectation* expectation;

  std::string name() const {
    std::string name = std::string(what->id) + "_" + what->claim + "_" + row->name;
    std::ranges::replace(name, '-', '_');
    return name;
  }
  friend void PrintTo(const Run& run, std::ostream* out) { *out << run.name(); }
};

std::vector<Run> runs() {
  std::vector<Run> all;
  for (const Case& what : cases()) {
    if (what.takes_long != VISUM_PHYSICS_LONG) continue;
    for (const EngineRow& row : engine_rows()) {
      const Expectation* expectation = find_expectation(what.id, row.name);
      if (expectation && !expectation->bounds.empty()) all.push_back({&what, &row, expectation});
    }
  }
  return all;
}

class Physics : public ::testing::TestWithParam<Run> {};

TEST_P(Physics, IsAsRightAsExpected) {
  const auto& [what, row, expectation] = GetParam();
  const std::vector<double> figures = run(*what, row->setting);
  ASSERT_EQ(expectation->bounds.size(), what->figures.size());
  for (std::size_t i = 0; i < figures.size(); ++i) {
    EXPECT_LE(figures[i], expectation->bounds[i]) << what->figures[i].name << ", against " << what->source;
    if (is_expected_right(*what, i, *row)) continue;
    EXPECT_GT(figures[i], what->figures[i].demand(row->setting))
        << what->figures[i].name << " is as demanded by now, and so should its bound be";
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Physics, ::testing::ValuesIn(runs()),
                         [](const auto& info) { return info.param.name(); });

TEST(PhysicsSuite, EveryCaseSaysWhatItExpectsOfEveryEngine) {
  for (const Case& what : cases()) {
    for (const EngineRow& row : engine_rows()) {
      const Expectation* expectation = find_expectation(what.id, row.name);
      ASSERT_TRUE(expectation) << what.id << " says nothing of " << row.name;
      EXPECT_EQ(expectation->bounds.empty(), !expectation->reason.empty()) << what.id << ", " << row.name;
    }
  }
}

bool is_direct_impulse(const EngineRow& row) {
  return row.setting.name == "impulse" && row.setting.solver == "direct";
}

const Miss* find_miss(const Case& what, const Figure& figure, const EngineRow& row) {
  const auto found = std::ranges::find_if(declared_misses(), [&](const Miss& miss) {
    return std::string(miss.id) == what.id && std::string(miss.figure) == figure.name && miss.row == row.name;
  });
  return found == declared_misses().end() ? nullptr : &*found;
}

// The expectations equal the demands, except for the misses that expectations.cc declares.
TEST(PhysicsSuite, TheImpulseEngineIsExpectedToBeRight) {
  for (const Case& what : cases()) {
    for (const EngineRow& row : engine_rows()) {
      const Expectation* expectation = find_expectation(what.id, row.name);
      if (!is_direct_impulse(row) || !expectation || expectation->bounds.empty()) continue;
      ASSERT_EQ(expectation->bounds.size(), what.figures.size()) << what.id;
      for (std::size_t i = 0; i < what.figures.size(); ++i)
        EXPECT_NE(is_expected_right(what, i, row), find_miss(what, what.figures[i], row) != nullptr)
            << what.id << " " << what.figures[i].name << " with " << row.name
            << ": a bound above the demand is to be declared, and no other";
    }
  }
}

TEST(PhysicsSuite, EveryDeclaredMissIsOfAFigureThatIsThere) {
  for (const Miss& miss : declared_misses()) {
    const Case& what = find_case(miss.id);
    EXPECT_TRUE(is_direct_impulse(engine_row(miss.row))) << miss.row;
    EXPECT_EQ(std::ranges::count_if(what.figures,
                                    [&](const Figure& one) { return std::string(one.name) == miss.figure; }),
              1)
        << miss.id << " " << miss.figure;
    EXPECT_STRNE(miss.reason, "");
  }
}

TEST(PhysicsSuite, NoExpectationIsOfACaseThatIsNotThere) {
  for (const Expectation& one : expectations()) EXPECT_NO_THROW(find_case(one.id));
}

}  // namespace
}  // namespace visum::physics
