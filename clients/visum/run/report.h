// How a run went: plain data, which reports.h shows in its forms.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/run/check.h"
#include "clients/visum/run/controllers.h"

namespace visum::run {

struct Report {
  std::string name, file, scene, clock, engine;            // engine: empty for the scene's own
  std::int64_t seed = -1;                                  // -1: the scene's own
  std::size_t run = 0;                                     // of a sweep, from 1; 0: no sweep
  std::vector<std::string> words;                          // options that a sweep started it with
  std::vector<std::pair<std::string, std::string>> swept;  // the sweep's values, for people
  std::string recording;                                   // its file; empty: none
  std::string recording_trouble;                           // why it is missing or cut short; empty: it is not
  cli::ExitCode code = cli::kDone;
  std::string error;                  // why the run could not go to its end; empty if it did
  std::vector<std::string> failures;  // of the run as a whole, e.g. an end that never came
  std::vector<CheckResult> checks;
  std::vector<ControllerResult> controllers;
  std::int64_t ticks = 0;
  double sim_seconds = 0.0;
  double wall_seconds = 0.0;  // of the stepping, without the start
  std::uint64_t state_hash = 0;
  std::uint64_t limited_ticks = 0;  // ticks whose work met a limit, and bodies that fell short in the last
  std::vector<std::string> limited_bodies;
  std::vector<std::pair<std::string, std::string>> files;  // that the scene was read from, with their XXH64
  std::vector<std::string> tripped;                        // drives in fault at the end, and why

  bool passed() const { return code == cli::kDone; }
};

// "name"; for a run of a sweep "name [run 3: payload=2, seed=1]".
std::string title(const Report& report);
std::string swept_text(const Report& report);  // "payload=2, seed=1"

}  // namespace visum::run
