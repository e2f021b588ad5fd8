// The suite's page agrees with expectations.cc: marks, demands, sources, misses. `physics_table --write`
// writes the page anew.
#include "tests/dynamics/physics/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace visum::physics {
namespace {

TEST(PhysicsPage, CountsWhatEachEngineMisses) {
  EXPECT_EQ(block(read_page(kPage), "misses"), misses_text());
}

TEST(PhysicsPage, TellsWhichCaseIsNotForWhichEngine) {
  EXPECT_EQ(block(read_page(kPage), "not run"), not_run_text());
}

TEST(PhysicsPage, WrapsItsListsAt100Columns) {
  std::istringstream lines(misses_text() + not_run_text());
  for (std::string line; std::getline(lines, line);) {
    const auto columns = std::ranges::count_if(line, [](char byte) { return (byte & 0xc0) != 0x80; });
    EXPECT_LE(columns, 100) << line;
    EXPECT_TRUE(line.starts_with("- ") || line.starts_with("  ")) << line;
  }
}

TEST(PhysicsPage, MarksEveryCaseAsItIsExpected) {
  const std::string table = block(read_page(kPage), "table");
  ASSERT_TRUE(table.starts_with(table_head())) << "other engines stand in the table's head";
  auto lines = table_lines(table);
  for (const Case& what : cases()) {
    const std::string line = lines[what.id];
    EXPECT_THAT(line, ::testing::StartsWith(line_start(what)));
    std::vector<std::string> expected;
    for (const std::string& row : expected_rows()) expected.push_back(text_of(expected_mark(what, row)));
    EXPECT_EQ(marks_of(line), expected) << what.id;
  }
  EXPECT_EQ(lines.size(), cases().size()) << "the table has cases that are not there";
}

TEST(PhysicsPage, ASharePastOneIsMissed) {
  const Case what{"X1", "Claim", "a | b", {{"m", 0.5}, {"count", 0.0}}, nullptr};
  EXPECT_EQ(worst_share(what, "ode", {0.25, 0.0}), 0.5);
  EXPECT_EQ(worst_share(what, "ode", {1.0, 0.0}), 2.0);
  EXPECT_TRUE(std::isinf(worst_share(what, "ode", {0.0, 1.0})));
}

TEST(PhysicsPage, ABlockIsReplacedAndReadBack) {
  const std::string page = "a\n<!-- physics_table: misses -->\nold\n<!-- physics_table: end -->\nb\n";
  const std::string written = with_block(page, "misses", "new\n");
  EXPECT_EQ(block(written, "misses"), "new\n");
  EXPECT_EQ(with_block(written, "misses", "old\n"), page);
  EXPECT_THROW(block(page, "table"), std::runtime_error);
}

TEST(PhysicsPage, ABarInASourceIsNoCell) {
  const Case what{"X1", "Claim", "a | b", {{"m", 0.5}}, nullptr};
  const auto marks = marks_of(line_start(what) + " ✓ 0.5 | — |");
  EXPECT_THAT(marks, ::testing::ElementsAre("✓", "—"));
}

}  // namespace
}  // namespace visum::physics
