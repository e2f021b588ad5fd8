// Runs of a sweep, several at a time, each in a process of its own: `visum run FILE --only K`, which a user
// may call too. Under lockstep the result of a run does not depend on the runs beside it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "clients/visum/run/report.h"

namespace visum::run {

struct ManyOptions {
  std::filesystem::path program;  // visum
  std::filesystem::path file;     // the scenario
  std::size_t runs = 1;
  std::size_t jobs = 1;                // at a time
  std::vector<std::string> words;      // further options for each run
  std::filesystem::path recordings{};  // a folder for recordings of runs that fail; empty: none
  std::function<void(const Report&)> on_done;
};

// Returns a report for each run, in order. An interrupt ends all runs. If a process cannot be started, the
// others run to their end. Runs that did not begin then have a report with the error "not started"; on_done
// is not called for them.
std::vector<Report> run_many(const ManyOptions& options);

// The exit code for all: 0 if all passed. Else the first of these that any run has: interrupted, wrong
// scenario, wrong options, wall time over, controller lost, check failed, invalid.
cli::ExitCode code_of(const std::vector<Report>& reports);

}  // namespace visum::run
