// The results of campaigns: kept, summed up and merged.
#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>
#include <functional>

#include "clients/visum/campaign/influence.h"
#include "clients/visum/campaign/merge.h"
#include "clients/visum/campaign/results.h"
#include "clients/visum/campaign/summary.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/temp_folder.h"
#include "clients/visum/compare/campaigns.h"
#include "clients/visum/run/sampling.h"

namespace visum::campaign {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string trouble(const std::function<void()>& act) {
  try {
    act();
  } catch (const cli::ExitError& error) {
    return error.what();
  }
  return "there was none";
}

Identity identity(const std::string& sweep = "s", std::size_t runs = 6) {
  return {"n", "n.yaml", sweep, "b", runs};
}

void add(Results& results, std::size_t run, int code = 0, const std::string& key = "", std::uint64_t hash = 0,
         const std::string& file_hash = "f") {
  Row row;
  row.run = run;
  row.parameters = "{\"a\":\"" + std::to_string(run) + "\"}";
  row.code = code;
  row.state_hash = hash != 0 ? hash : run;
  row.key = key.empty() ? "key " + std::to_string(run) : key;
  row.reusable = code <= 1;
  run::Report report;
  report.files = {{"scene.yaml", file_hash}};
  report.checks.push_back({"c", "of", "below 3 m", "m", code == 0, static_cast<double>(run), 1.0, ""});
  report.checks.back().margin = 3.0 - static_cast<double>(run);
  results.add(row, report, "host");
}

TEST(Results, ComeBackAsTheyWere) {
  const cli::TempFolder folder;
  {
    Results results(folder.path(), identity(), {});
    add(results, 2, 1);
  }  // without close(), as where a process is killed
  Results back(folder.path());
  EXPECT_EQ(back.identity(), identity());
  const auto row = back.find(2);
  ASSERT_TRUE(row);
  EXPECT_EQ(row->code, 1);
  EXPECT_EQ(row->key, "key 2");
  EXPECT_EQ(row->parameters, "{\"a\":\"2\"}");
  EXPECT_THAT(back.files(row->files), ElementsAre(std::pair<std::string, std::string>("scene.yaml", "f")));
  EXPECT_FALSE(back.find(1));
}

TEST(Results, TwoCannotWriteAtATime) {
  const cli::TempFolder folder;
  const Results first(folder.path(), identity(), {});
  EXPECT_THAT(trouble([&] { Results(folder.path(), identity(), {}); }),
              HasSubstr("another run writes to it now"));
}

TEST(Results, ThoseOfAnotherSweepAreKeptAside) {
  const cli::TempFolder folder;
  for (const char* sweep : {"s", "t", "u"}) {
    Results results(folder.path(), identity(sweep), {});
    EXPECT_FALSE(results.find(1));
    add(results, 1, 0, std::string("key of ") + sweep);
    add(results, 2, 0, std::string("other of ") + sweep);
  }
  Results results(folder.path(), identity("v"), {});
  for (const char* sweep : {"s", "t", "u"}) {
    const auto earlier = results.find_earlier(std::string("key of ") + sweep);
    ASSERT_TRUE(earlier) << sweep;
    results.adopt(*earlier, sweep[0] == 's' ? 3 : sweep[0] == 't' ? 4 : 5, "{}");
  }
  EXPECT_EQ(results.find(4)->key, "key of t");
  EXPECT_EQ(summarize(results).checks.at(0).runs, 3u) << "their checks come with them";
  EXPECT_FALSE(results.find_earlier("key of s")) << "it has been adopted";
  results.forget_earlier();
  EXPECT_FALSE(results.find_earlier("other of s"));
}

TEST(Results, AFullDiskEndsItAndLosesNothing) {
  const cli::TempFolder folder;
  std::size_t written = 0;
  {
    Results results(folder.path(), identity("s", 100'000), {});
    results.database().run("PRAGMA max_page_count=40");
    EXPECT_THAT(trouble([&] {
                  for (std::size_t run = 1; run < 100'000; ++run, ++written) add(results, run);
                }),
                HasSubstr("the disk is full; what was written before is kept"));
  }
  EXPECT_GT(written, 10u);
  Results back(folder.path());
  std::size_t kept = 0;
  back.for_each(100'000, [&](const Row& row) { EXPECT_EQ(row.run, ++kept); });
  EXPECT_EQ(kept, written);
}

TEST(Results, WhatIsNoDatabaseIsSaidToBe) {
  const cli::TempFolder folder;
  EXPECT_THAT(trouble([&] { Results(folder.path()); }), HasSubstr("holds no results.sqlite"));
  FILE* file = std::fopen((folder.path() / "results.sqlite").c_str(), "w");
  for (int i = 0; i < 1000; ++i) std::fputs("this is text\n", file);
  std::fclose(file);
  EXPECT_THAT(trouble([&] { Results(folder.path(), identity(), {}); }),
              HasSubstr("no results that can be read"));
}

TEST(Summary, CountsAndFindsTheWorst) {
  const cli::TempFolder folder;
  Results results(folder.path(), identity(), {});
  for (std::size_t run = 1; run <= 6; ++run)
    add(results, run, run <= 3 ? 0 : run == 4 ? 1 : run == 5 ? 4 : 6);
  const Summary summary = summarize(results);
  EXPECT_EQ(summary.runs, 6u);
  EXPECT_EQ(summary.passed, 3u);
  EXPECT_EQ(summary.failed, 2u) << "a lost controller fails";
  EXPECT_EQ(summary.invalid, 1u);
  EXPECT_EQ(summary.pass_rate, 0.6);
  EXPECT_EQ(summary.code(), cli::kFailed);
  ASSERT_EQ(summary.checks.size(), 1u);
  EXPECT_EQ(summary.checks[0].median, 4.0);
  EXPECT_EQ(summary.checks[0].worst_run, 6u);
  EXPECT_EQ(summary.checks[0].margin, -3.0);
}

TEST(Summary, HashesTheRunsAndNothingElse) {
  const cli::TempFolder one, two;
  Results first(one.path(), identity(), {}), second(two.path(), identity(), {});
  for (std::size_t run = 1; run <= 6; ++run) add(first, run);
  for (std::size_t run = 6; run >= 1; --run) add(second, run);
  const auto hash = summarize(first).hash;
  EXPECT_EQ(summarize(second).hash, hash);
  add(second, 3, 0, "", 77);
  EXPECT_NE(summarize(second).hash, hash);
}

TEST(Summary, AMissingRunIsNoGreenResult) {
  const cli::TempFolder folder;
  Results results(folder.path(), identity(), {});
  for (const std::size_t run : {1u, 2u, 5u}) add(results, run);
  const Summary summary = summarize(results);
  EXPECT_THAT(summary.missing, ElementsAre(3u, 4u, 6u));
  EXPECT_EQ(summary.code(), cli::kInvalid);
}

TEST(Summary, EqualRunsWithDifferentStatesAreInvalid) {
  const cli::TempFolder folder;
  Results results(folder.path(), identity(), {});
  for (std::size_t run = 1; run <= 6; ++run) add(results, run, 0, run == 2 || run == 5 ? "same" : "", run);
  const Summary summary = summarize(results);
  EXPECT_THAT(summary.nondeterministic, ElementsAre(2u, 5u));
  EXPECT_EQ(summary.invalid, 2u);
  EXPECT_EQ(summary.code(), cli::kInvalid);
}

TEST(Summary, AFileThatChangedMeanwhileIsTold) {
  const cli::TempFolder folder;
  Results results(folder.path(), identity(), {});
  for (std::size_t run = 1; run <= 6; ++run) add(results, run, 0, "", 0, run == 4 ? "changed" : "f");
  EXPECT_THAT(summarize(results).changed, ElementsAre("scene.yaml"));
  EXPECT_EQ(summarize(results).code(), cli::kInvalid);
  add(results, 4);
  EXPECT_THAT(summarize(results).changed, IsEmpty());
}

TEST(Summary, EndsWhereItIsDecided) {
  const cli::TempFolder folder;
  Identity claimed = identity("s", 1000);
  claimed.decide = run::Decide{0.9, 0.5, 0.05, 0.05};
  Results results(folder.path(), claimed, {});
  for (std::size_t run = 1; run <= 20; ++run) add(results, run, run == 15 ? 1 : 0);
  const Summary summary = summarize(results);
  EXPECT_EQ(summary.decision, Decision::kAccepted);
  EXPECT_EQ(summary.decided_at, 6u);  // ln(0.5/0.9) six times is less than -ln(19)
  EXPECT_EQ(summary.runs, 6u);
  EXPECT_EQ(summary.failed, 0u);
  EXPECT_EQ(summary.code(), cli::kDone);
}

// margin = 2a + b + c: of two uniform numbers and one of two values (variance 1/4). The variances are 4/12,
// 1/12 and 1/4, so the shares are 1/2, 1/8 and 3/8; d does nothing.
TEST(Influence, IsTheShareOfTheVariance) {
  const cli::TempFolder folder;
  constexpr std::size_t kRuns = 4096;
  Results results(folder.path(), identity("s", kRuns), {});
  const auto sobol = run::Sampling::read(
      config::load_text("sampling: {method: sobol, runs: " + std::to_string(kRuns) + "}", "s.yaml"));
  for (std::size_t k = 1; k <= kRuns; ++k) {
    const double a = sobol->share(0, k), b = sobol->share(1, k);
    const bool c = sobol->share(2, k) < 0.5;
    Row row;
    row.run = k;
    row.parameters = "{\"a\":\"" + std::to_string(a) + "\",\"b\":\"" + std::to_string(b) + "\",\"c\":\"" +
                     (c ? "yes" : "no") + "\",\"d\":\"" + std::to_string(sobol->share(3, k)) + "\"}";
    run::Report report;
    report.checks.push_back({"m", "of", "below 3 m", "m", true, 0.0, 1.0, ""});
    report.checks.back().margin = 2.0 * a + b + (c ? 1.0 : 0.0);
    results.add(row, report, "host");
  }
  const auto influences = InfluenceOfParameters(results, kRuns).on("m");
  ASSERT_EQ(influences.size(), 4u);
  const double expected[] = {0.5, 0.375, 0.125, 0.0};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(influences[i].share, expected[i], 0.01) << influences[i].parameter;
  EXPECT_EQ(influences[1].parameter, "c");
}

TEST(Influence, IsNotGuessedFromAFewRuns) {
  const cli::TempFolder folder;
  Results results(folder.path(), identity(), {});
  for (std::size_t run = 1; run <= 6; ++run) add(results, run);
  EXPECT_THAT(InfluenceOfParameters(results, 6).on("c"), IsEmpty());
  EXPECT_EQ(share_between({1, 1, 1, 1, 1, 1, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}, 2), 0.0);
  EXPECT_EQ(share_between({1, 1, 1, 1, 2, 2, 2, 2}, {0, 0, 0, 0, 1, 1, 1, 1}, 2), 1.0);
}

TEST(Merge, RefusesWhatIsMissingDoubledOrForeign) {
  const cli::TempFolder folder;
  const auto shard = [&](const char* name, const Identity& of, std::size_t index) {
    Results results(folder.path() / name, of, {index, 2});
    for (std::size_t run = index; run <= 6; run += 2) add(results, run);
    return folder.path() / name;
  };
  const auto one = shard("one", identity(), 1), two = shard("two", identity(), 2);
  auto other_build = identity();
  other_build.build = "c";
  const auto built = shard("built", other_build, 2), swept = shard("swept", identity("t"), 2);
  const auto out = folder.path() / "out";
  EXPECT_THAT(merge({one}, out).missing, ElementsAre(2u, 4u, 6u));
  EXPECT_THAT(merge({one, one, two}, out).doubled, ElementsAre(1u, 3u, 5u));
  EXPECT_THAT(merge({one, built}, out).foreign, ElementsAre(HasSubstr("another build (c, not b)")));
  EXPECT_THAT(merge({one, swept}, out).foreign, ElementsAre(HasSubstr("another sweep")));
  EXPECT_FALSE(std::filesystem::exists(out));
  const auto merged = merge({two, one}, out);
  EXPECT_TRUE(merged.good());
  EXPECT_EQ(merged.runs, 6u);
  EXPECT_TRUE(std::filesystem::exists(out / "results.csv"));
  EXPECT_THAT(trouble([&] { merge({one, two}, out); }), HasSubstr("holds results already"));
}

TEST(Merge, AFileThatDiffersBetweenShardsIsForeign) {
  const cli::TempFolder folder;
  for (const std::size_t index : {1u, 2u}) {
    Results results(folder.path() / std::to_string(index), identity("s", 2), {index, 2});
    add(results, index, 0, "", 0, std::to_string(index));
  }
  EXPECT_THAT(merge({folder.path() / "1", folder.path() / "2"}, folder.path() / "out").foreign,
              ElementsAre(HasSubstr("scene.yaml: not the same for all runs")));
}

// By hand: 2 * 0.5^6, and 2 * (1 + 8) / 256.
TEST(McNemar, IsTheBinomialsTwoTails) {
  EXPECT_NEAR(compare::mcnemar(0, 6), 0.03125, 1e-12);
  EXPECT_NEAR(compare::mcnemar(7, 1), 0.0703125, 1e-12);
  EXPECT_EQ(compare::mcnemar(3, 3), 1.0);
  EXPECT_EQ(compare::mcnemar(0, 0), 1.0);
  EXPECT_LT(compare::mcnemar(100'000, 110'000), 1e-100);
}

}  // namespace
}  // namespace visum::campaign
