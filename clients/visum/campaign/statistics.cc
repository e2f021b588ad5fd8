#include "clients/visum/campaign/statistics.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/exp_log.h"

namespace visum::campaign {
namespace {

constexpr double kZ = 1.959963984540054;  // 97.5 % of a normal distribution lie below it

}  // namespace

Interval wilson(std::uint64_t passed, std::uint64_t all) {
  if (all == 0) return {};
  const auto n = static_cast<double>(all);
  const double share = static_cast<double>(passed) / n;
  const double scale = 1.0 + kZ * kZ / n, middle = share + kZ * kZ / (2.0 * n);
  const double half = kZ * std::sqrt(share * (1.0 - share) / n + kZ * kZ / (4.0 * n * n));
  return {passed == 0 ? 0.0 : std::max(0.0, (middle - half) / scale),
          passed == all ? 1.0 : std::min(1.0, (middle + half) / scale)};
}

const char* to_text(Decision decision) {
  if (decision == Decision::kAccepted) return "accepted";
  return decision == Decision::kRejected ? "rejected" : "undecided";
}

// The ratio is that of `reject_below` to `at_least`: it grows with each failure.
SequentialTest::SequentialTest(const run::Decide& decide)
    : pass_(config::logarithm(decide.reject_below / decide.at_least)),
      fail_(config::logarithm((1.0 - decide.reject_below) / (1.0 - decide.at_least))),
      accept_(config::logarithm(decide.false_accept / (1.0 - decide.false_reject))),
      reject_(config::logarithm((1.0 - decide.false_accept) / decide.false_reject)) {}

void SequentialTest::take(Outcome outcome) {
  if (decision_ != Decision::kUndecided) return;
  least_ += outcome == Outcome::kFailed ? fail_ : pass_;
  most_ += outcome == Outcome::kPassed ? pass_ : fail_;
  if (most_ <= accept_) decision_ = Decision::kAccepted;
  if (least_ >= reject_) decision_ = Decision::kRejected;
}

}  // namespace visum::campaign
