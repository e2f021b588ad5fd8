// Compares the results of two campaigns of equal runs: two controllers, two versions of Visum, two engines.
// Any one thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace visum::compare {

// A check, or the verdict of a whole run, over the runs that both have with equal values.
struct CheckComparison {
  std::string check, unit;
  std::uint64_t both = 0, only_a = 0, only_b = 0, neither = 0;  // runs that pass it
  // How likely such different counts are if both are equally good: McNemar's test, exact, two-sided.
  double p = 1.0;
  // The value's difference, B less A, paired: its mean, and between which figures the mean of all possible
  // runs lies with 95 %. Nothing below 2 runs.
  std::optional<double> mean, low, high;
  double max_abs = 0.0;
  std::uint64_t max_run = 0;  // which has that; 0: no value differs
};

// A run that ends differently.
struct RunPair {
  std::uint64_t run = 0;
  std::string values;                    // of the sweep, "mass=0.2, seed=1"
  std::string a, b;                      // "passed", "failed" or "invalid"
  std::string recording_a, recording_b;  // paths; empty: there is none
  bool turned() const { return a != b; }
};

struct CampaignComparison {
  bool equal = true;                               // the same runs, with the same codes and states
  std::uint64_t runs = 0, only_a = 0, only_b = 0;  // paired; of one only
  std::uint64_t invalid = 0;                       // in one of the two, and so left out of the statistics
  // Runs with another code or state, at most 1000: first those whose verdict is another, then in their order.
  std::vector<RunPair> different;
  std::uint64_t different_count = 0, turned_count = 0;  // all; of those, the ones with another verdict
  std::vector<std::string> settings;  // how the two were made differently, "build: 0.2.0 1f..., 0.2.0 9a..."
  CheckComparison verdict;            // named "passed"
  std::vector<CheckComparison> checks;
};

// `a`, `b`: folders of `visum campaign` or `visum report merge`. Throws cli::ExitError where one holds no
// results.
CampaignComparison compare_campaigns(const std::filesystem::path& a, const std::filesystem::path& b);

// The probability of at most min(a, b) or at least max(a, b) heads among a + b throws of a fair coin.
double mcnemar(std::uint64_t a, std::uint64_t b);

}  // namespace visum::compare
