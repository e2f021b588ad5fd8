// The pages that show the suite say what expectations.cc says: marks, demands, sources, what is missed.
// `physics_table --write` writes them anew.
#include "tests/dynamics/physics/page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace visum::physics {
namespace {

TEST(PhysicsPage, CountsWhatEachEngineMisses) {
  for (const char* path : kPagesWithMisses)
    EXPECT_EQ(block(read_page(path), "misses"), misses_text()) << path;
}

TEST(PhysicsPage, TellsWhichCaseIsNotForWhichEngine) {
  EXPECT_EQ(block(read_page(kTablePage), "not run"), not_run_text());
}

TEST(PhysicsPage, MarksEveryCaseAsItIsExpected) {
  const std::string table = block(read_page(kTablePage), "table");
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
