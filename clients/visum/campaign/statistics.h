// The statistics of a campaign. Pure; the same bits on every processor.
#pragma once

#include <cstdint>
#include <optional>

#include "clients/visum/run/decide.h"

namespace visum::campaign {

struct Interval {
  double low = 0.0, high = 1.0;
};

// The share of all possible runs that pass, with 95 % confidence. Wilson, Probable inference, the law of
// succession, and statistical inference, JASA 22 (1927). Of no runs: 0 to 1.
Interval wilson(std::uint64_t passed, std::uint64_t all);

enum class Decision { kAccepted, kRejected, kUndecided };
const char* to_text(Decision decision);

// Wald's sequential probability ratio test (Sequential Tests of Statistical Hypotheses, Annals of
// Mathematical Statistics 16, 1945): reads runs in their order and decides as soon as it may. A run that is
// invalid says nothing, so a verdict needs to hold whether it would have passed or failed.
class SequentialTest {
 public:
  explicit SequentialTest(const run::Decide& decide);

  enum class Outcome { kPassed, kFailed, kInvalid };
  void take(Outcome outcome);  // the next run; of no effect once it has decided
  Decision decision() const { return decision_; }

 private:
  const double pass_, fail_;  // what a run adds to the logarithm of the ratio
  const double accept_, reject_;
  double least_ = 0.0, most_ = 0.0;  // the logarithm, with invalid runs taken as passed, as failed
  Decision decision_ = Decision::kUndecided;
};

}  // namespace visum::campaign
