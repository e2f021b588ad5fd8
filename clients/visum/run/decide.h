// The `decide:` of a scenario: the claim of a campaign, and the risks of deciding it wrongly.
//
//   decide: {at_least: 0.99, reject_below: 0.97, false_reject: 0.05, false_accept: 0.05}
#pragma once

#include <optional>

#include "protocol/config/config.h"

namespace visum::run {

struct Decide {
  double at_least = 0.0;       // share of runs that pass, as claimed
  double reject_below = 0.0;   // a share this low must be found out
  double false_reject = 0.05;  // risk of rejecting where the share is `at_least`
  double false_accept = 0.05;  // risk of accepting where it is `reject_below`
};

// `root` is the scenario's whole file. Throws config::ConfigError.
std::optional<Decide> read_decide(const config::Node& root);

}  // namespace visum::run
