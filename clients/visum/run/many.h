// The runs of a sweep, in processes of their own, so many at a time: each is `visum run FILE --only K`, which
// a user may call too. Which of them runs beside which changes nothing in what a run under lockstep finds.
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
  std::filesystem::path file;     // the scenario's
  std::size_t runs = 1;
  std::size_t jobs = 1;                // at a time
  std::vector<std::string> words;      // further words for each run
  std::filesystem::path recordings{};  // a folder: what fails is recorded there; empty: nothing is
  std::function<void(const Report&)> on_done;
};

// By run. After an interrupt, once all that ran has been ended, or where a process cannot be started (those
// that run go on to their end), the rest is there as not started, with an error and without a call of
// on_done.
std::vector<Report> run_many(const ManyOptions& options);

// 0 where all passed, else the code that says most: interrupted, then a wrong scenario, wrong options, the
// wall time over, a controller lost, a check failed.
cli::ExitCode code_of(const std::vector<Report>& reports);

}  // namespace visum::run
