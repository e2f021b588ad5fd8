// Runs of a sweep, several at a time, by a few processes (worker.h). Each gives what `visum run FILE --only
// K` gives, which a user may call too. Under lockstep the result of a run does not depend on the runs beside
// it, or before it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clients/visum/run/report.h"

namespace visum::run {

struct ManyOptions {
  std::filesystem::path program;        // visum
  std::filesystem::path file;           // the scenario
  std::size_t runs = 1;                 // of the whole sweep
  std::size_t jobs = 1;                 // at a time
  std::vector<std::string> words;       // further options for each run
  std::filesystem::path recordings{};   // a folder for recordings of runs that fail; empty: none
  bool keeps_all = false;               // also those of runs that pass
  std::function<std::size_t()> next{};  // the run to begin next; 0: none is left. Of run_each() only
  // The sweep's values of a run, as YAML, where its number does not tell them. Of run_each() only
  std::function<std::string(std::size_t run)> values{};
  std::function<void(std::size_t run, const Report&)> on_done{};
};

// Why no further runs began.
struct Stopped {
  std::size_t run = 0;  // the first that did not
  cli::ExitCode code = cli::kFailed;
  std::string why;
};

// Begins run after run, as `next` says. An interrupt ends all runs. If a process cannot be started, the
// others run to their end. Calls on_done for each run that began, in the order in which they end.
std::optional<Stopped> run_each(const ManyOptions& options);

// Returns a report for each run, in order. Those that did not begin say "not started"; on_done is not called
// for them.
std::vector<Report> run_many(const ManyOptions& options);

// The exit code for all: 0 if all passed. Else the first of these that any run has: interrupted, wrong
// scenario, wrong options, wall time over, controller lost, check failed, invalid.
cli::ExitCode code_of(const std::vector<Report>& reports);

}  // namespace visum::run
