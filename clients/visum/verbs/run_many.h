// `visum run` for a scenario with a sweep, or with --report: starts its runs side by side and writes one
// report.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "protocol/config/config.h"

namespace visum::cli {

struct ManyRunsOptions {
  std::string file;                  // the scenario
  std::string report;                // a folder; empty: none
  std::string junit;                 // a file; empty: none
  std::filesystem::path recordings;  // a folder for recordings of runs that fail; empty: none
  bool keeps_all = false;            // also those of runs that pass
  std::vector<std::string> words;    // options that each run gets too
  std::size_t jobs = 1;              // at a time; 0: as many as there are processors
  bool json = false;
  bool events = false;  // on standard output, see run/event_lines.h
};

// Throws ExitError if the file cannot be written. Asked before a run, whose result would be lost otherwise.
void check_writable(const std::string& file);

// `root` is the content of the file. Returns the exit code. Throws ExitError and config::ConfigError.
int run_many(const ManyRunsOptions& wanted, const config::Node& root);

}  // namespace visum::cli
