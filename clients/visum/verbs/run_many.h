// `visum run` of a scenario that sweeps, or with --report: its runs side by side, and one report of all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/config/config.h"

namespace visum::cli {

struct ManyRunsOptions {
  std::string file;                  // the scenario's
  std::string report;                // a folder; empty: none
  std::string junit;                 // a file; empty: none
  std::filesystem::path recordings;  // a folder for those of runs that fail; empty: none
  std::vector<std::string> words;    // that each run is given too
  std::size_t jobs = 1;              // 0: as many as there are processors
  bool json = false;
};

// Before a run, so that a report that cannot be written does not cost one. Throws ExitError.
void check_writable(const std::string& file);

// `root`: what stands in the file. Returns the exit code; throws ExitError, config::ConfigError.
int run_many(const ManyRunsOptions& words, const config::Node& root);

}  // namespace visum::cli
