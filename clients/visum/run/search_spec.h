// The `search:` of a scenario: how a campaign looks for what breaks a check, or comes nearest to it.
//
//   search: {check: upright, runs: 500, population: 12, seed: 1, until: broken}
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "protocol/config/config.h"

namespace visum::run {

struct SearchSpec {
  std::size_t check = 0;       // whose margin is made small: its place among the checks, from 0
  std::string name;            // of that check, for people
  std::size_t runs = 1;        // that the search makes at most, beside the campaign's own
  std::size_t population = 0;  // runs of a generation; 0: by the number of parameters
  std::uint64_t seed = 0;
  bool until_broken = false;  // ends with the first generation that breaks the check
};

// `root` is the scenario's whole file. Throws config::ConfigError.
std::optional<SearchSpec> read_search(const config::Node& root);

}  // namespace visum::run
