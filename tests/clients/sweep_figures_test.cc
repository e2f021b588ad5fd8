// The pictures of a sweep: the map counts the runs of each cell, and each check is drawn over what matters
// for it.
#include "clients/visum/run/sweep_figures.h"

#include <gtest/gtest.h>

namespace visum::run {
namespace {

using Outcome = SweptRun::Outcome;

// Fails where mass times slope is large; `seed` says nothing. Runs 1 to 18.
std::vector<SweptRun> sweep() {
  std::vector<SweptRun> runs;
  for (const char* seed : {"1", "2"})
    for (const char* mass : {"0.1", "0.2", "0.3"})
      for (const char* slope : {"0", "5", "10"}) {
        const double height = std::stod(mass) * std::stod(slope);
        runs.push_back({runs.size() + 1,
                        height < 1.8 ? Outcome::kPassed : Outcome::kFailed,
                        {{"seed", seed}, {"mass", mass}, {"slope", slope}},
                        "run_" + std::to_string(runs.size() + 1) + ".mcap",
                        {{"height", height}}});
      }
  return runs;
}

const std::vector<FigureCheck> kChecks{{"height", "m", "below 1.8 m"}};

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (auto at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++found;
  return found;
}

TEST(SweepFigures, MapTheTwoParametersThatMatter) {
  const auto html = sweep_figures(sweep(), kChecks);
  EXPECT_EQ(count(html, "aria-label=\"Runs that passed over slope and mass\""), 1u);
  EXPECT_EQ(count(html, "class=\"cell\""), 9u);
  EXPECT_EQ(count(html, ">2/2</text>"), 7u);
  EXPECT_EQ(count(html, ">0/2</text>"), 2u);
  // The first run of the cell that failed, and where more of it is
  EXPECT_EQ(count(html, "<a href=\"run_9.mcap\"><rect"), 1u);
  EXPECT_EQ(count(html, "slope 10, mass 0.3: 0 of 2 passed; run 9"), 1u);
}

TEST(SweepFigures, DrawEachCheckOverWhatMattersForIt) {
  const auto html = sweep_figures(sweep(), kChecks);
  EXPECT_EQ(count(html, "aria-label=\"height over slope\""), 1u);
  EXPECT_EQ(count(html, "must be below 1.8 m"), 1u);
  EXPECT_EQ(count(html, "<circle class=\"passed\""), 14u);
  EXPECT_EQ(count(html, "<circle class=\"failed\""), 4u);
}

TEST(SweepFigures, GroupManyValuesAndDrawABand) {
  std::vector<SweptRun> runs;
  for (std::size_t i = 0; i < 600; ++i)
    runs.push_back({i + 1,
                    Outcome::kPassed,
                    {{"a", std::to_string(i)}, {"b", std::to_string(i % 2)}},
                    "",
                    {{"height", 1.0}}});
  const auto html = sweep_figures(runs, kChecks);
  EXPECT_EQ(count(html, "class=\"cell\""), 24u);
  EXPECT_EQ(count(html, "<circle"), 0u);
  EXPECT_EQ(count(html, "class=\"band\""), 1u);
  EXPECT_EQ(count(html, "<a href"), 0u);
}

TEST(SweepFigures, InvalidRunsCountForNothing) {
  auto runs = sweep();
  for (auto& run : runs) run.outcome = Outcome::kInvalid;
  EXPECT_EQ(count(sweep_figures(runs, kChecks), ">?</text>"), 6u)
      << "nothing matters, so it is over the first two parameters";
}

TEST(SweepFigures, AreLeftOutWhereNothingIsSwept) {
  EXPECT_EQ(sweep_figures({}, kChecks), "");
  const std::vector<SweptRun> same(3, {1, Outcome::kPassed, {{"mass", "1"}}, "", {{"height", 1.0}}});
  EXPECT_EQ(sweep_figures(same, kChecks), "");
  std::vector<SweptRun> names;
  for (std::size_t i = 0; i < 40; ++i)
    names.push_back({i + 1, Outcome::kPassed, {{"file", "a" + std::to_string(i)}}, "", {}});
  EXPECT_EQ(sweep_figures(names, kChecks), "") << "forty names are no scale";
}

}  // namespace
}  // namespace visum::run
