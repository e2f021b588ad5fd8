// Searches the space of a campaign's sweep for the run that breaks a check, or comes nearest to it: CMA-ES
// from the best points of the campaign, a generation at a time. Its runs are numbered behind the campaign's
// own, and are kept as those are; the verdict does not count them. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "clients/visum/campaign/results.h"
#include "clients/visum/campaign/work.h"
#include "clients/visum/run/many.h"
#include "clients/visum/run/search_spec.h"
#include "protocol/config/config.h"

namespace visum::campaign {

struct SearchDone {
  std::string check, unit;  // what was searched
  std::size_t runs = 0, generations = 0, starts = 0;
  std::size_t broken = 0, invalid = 0, reused = 0;  // of its runs
  std::size_t first_broken = 0;                     // the first run of the search that broke it; 0: none
  std::uint64_t hash = 0;                           // of the search's runs, as Summary::hash
  // The worst of all runs, those of the campaign included; 0: no run said anything about the check.
  std::size_t worst_run = 0;
  std::optional<double> margin;         // of that; nothing: it failed before the check could be measured
  std::string values;                   // "mass=0.2, friction=0.5"
  std::string scenario, recording;      // its files, relative to the folder; empty: not written
  std::string trouble;                  // why one of them is missing or wrong
  std::optional<run::Stopped> stopped;  // why it is not complete
};

// `results`: of the campaign, whose runs up to number `last` count. Throws cli::ExitError where results
// cannot be written.
SearchDone search(const config::Node& root, const run::SearchSpec& spec, const WorkOptions& options,
                  Results& results, std::size_t last);

}  // namespace visum::campaign
