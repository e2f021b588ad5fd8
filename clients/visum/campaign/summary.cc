#include "clients/visum/campaign/summary.h"

#include <algorithm>

#include "clients/visum/campaign/run_hash.h"

namespace visum::campaign {
namespace {

constexpr std::size_t kMostChecks = 100;

SequentialTest::Outcome outcome_of(const Row& row, const std::vector<std::size_t>& nondeterministic) {
  const bool doubted = std::ranges::binary_search(nondeterministic, row.run);
  return doubted ? SequentialTest::Outcome::kInvalid : row.outcome();
}

void count(const Row& row, SequentialTest::Outcome outcome, Summary& summary) {
  ++summary.runs;
  if (outcome == SequentialTest::Outcome::kPassed) ++summary.passed;
  if (outcome == SequentialTest::Outcome::kFailed) ++summary.failed;
  if (outcome == SequentialTest::Outcome::kInvalid) ++summary.invalid;
  if (outcome != SequentialTest::Outcome::kPassed && summary.failures.size() < Summary::kShownFailures)
    summary.failures.push_back(row);
}

std::optional<double> quantile(Results& results, const std::string& check, std::size_t last,
                               std::size_t values, double share) {
  if (values == 0) return std::nullopt;
  Statement found(results.database(),
                  "SELECT value FROM checks WHERE name = ? AND run > 0 AND run <= ? AND value IS NOT NULL "
                  "ORDER BY value LIMIT 1 OFFSET ?");
  found.bind(check).bind(last).bind(static_cast<std::size_t>(share * static_cast<double>(values - 1) + 0.5));
  return found.step() ? found.real(0) : std::nullopt;
}

std::vector<CheckFigures> figures_of(Results& results, std::size_t last) {
  std::vector<CheckFigures> checks;
  const InfluenceOfParameters influence(results, last);
  Statement names(
      results.database(),
      "SELECT name, MIN(unit), MIN(bound), COUNT(DISTINCT bound), COUNT(*), SUM(passed), COUNT(value) "
      "FROM checks WHERE run > 0 AND run <= ? GROUP BY name ORDER BY MIN(number), name LIMIT " +
          std::to_string(kMostChecks));
  names.bind(last);
  while (names.step()) {
    CheckFigures one;
    one.name = names.text(0);
    one.unit = names.text(1);
    one.bound = names.integer(3) == 1 ? names.text(2) : "as swept";
    one.runs = names.size(4);
    one.passed = names.size(5);
    const std::size_t values = names.size(6);
    one.least = quantile(results, one.name, last, values, 0.0);
    one.low = quantile(results, one.name, last, values, 0.05);
    one.median = quantile(results, one.name, last, values, 0.5);
    one.high = quantile(results, one.name, last, values, 0.95);
    one.most = quantile(results, one.name, last, values, 1.0);
    Statement worst(
        results.database(),
        "SELECT run, margin FROM checks WHERE name = ? AND run > 0 AND run <= ? AND margin IS NOT NULL "
        "ORDER BY margin, run LIMIT 1");
    if (worst.bind(one.name).bind(last).step()) {
      one.worst_run = worst.size(0);
      one.margin = worst.real(1);
    }
    one.influences = influence.on(one.name);
    checks.push_back(std::move(one));
  }
  return checks;
}

std::vector<std::string> changed_files(Results& results, std::size_t last) {
  std::vector<std::string> changed;
  Statement found(results.database(),
                  "SELECT path FROM files WHERE part IN (SELECT files FROM runs WHERE run > 0 AND run <= ?) "
                  "GROUP BY path HAVING COUNT(DISTINCT hash) > 1 ORDER BY path LIMIT 100");
  found.bind(last);
  while (found.step()) changed.push_back(found.text(0));
  return changed;
}

}  // namespace

cli::ExitCode Summary::code() const {
  if (decide) {
    if (decision == Decision::kUndecided) return cli::kInvalid;
    return decision == Decision::kAccepted ? cli::kDone : cli::kFailed;
  }
  if (failed > 0 || (search && search->broken > 0)) return cli::kFailed;
  return invalid > 0 || (search && search->invalid > 0) || !complete() || !changed.empty() ? cli::kInvalid
                                                                                           : cli::kDone;
}

Summary summarize(Results& results) {
  Summary summary;
  summary.all = results.shard().runs(results.identity().runs);
  const Shard shard = results.shard();
  if (shard.count == 1) summary.decide = results.identity().decide;
  const std::size_t all = results.identity().runs;
  const auto doubted = results.nondeterministic(all);
  std::optional<SequentialTest> test;
  if (summary.decide) test.emplace(*summary.decide);
  RunHash hash;
  std::size_t due = shard.first();
  // A verdict reads runs in their order: behind a gap it reads no more.
  const auto note_missing = [&](std::size_t before) {
    for (; due < before; due += shard.count)
      if (summary.missing.size() < Results::kMostListed) summary.missing.push_back(due);
  };
  results.for_each(all, [&](const Row& row) {
    if (summary.decided_at != 0) return;
    note_missing(row.run);
    due = row.run + shard.count;
    const auto outcome = outcome_of(row, doubted);
    hash.take(row);
    count(row, outcome, summary);
    if (!test || !summary.missing.empty()) return;
    test->take(outcome);
    if (test->decision() != Decision::kUndecided) summary.decided_at = row.run;
  });
  const std::size_t last = summary.decided_at != 0 ? summary.decided_at : all;
  if (summary.decided_at == 0) note_missing(all + 1);
  for (const std::size_t run : doubted)
    if (run <= last) summary.nondeterministic.push_back(run);
  summary.changed = changed_files(results, last);
  if (test && summary.changed.empty()) summary.decision = test->decision();
  const std::size_t valid = summary.passed + summary.failed;
  summary.pass_rate = valid == 0 ? 0.0 : static_cast<double>(summary.passed) / static_cast<double>(valid);
  summary.interval = wilson(summary.passed, valid);
  summary.hash = hash.value();
  summary.checks = figures_of(results, last);
  return summary;
}

}  // namespace visum::campaign
