// The runs of a campaign, or of one shard of it, on this machine. What an earlier execution finished is not
// done again. One thread; runs are processes of their own (clients/visum/run/many.h).
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clients/visum/campaign/progress.h"
#include "clients/visum/campaign/results.h"
#include "clients/visum/campaign/shard.h"
#include "clients/visum/run/many.h"
#include "protocol/config/config.h"

namespace visum::campaign {

struct WorkOptions {
  std::filesystem::path file;      // the scenario
  std::filesystem::path folder;    // for the results
  std::vector<std::string> words;  // options of each run
  std::size_t jobs = 1;            // runs at a time
  Shard shard;
  bool records = true;                               // keeps recordings of runs that fail, in `folder`
  bool records_all = false;                          // and of all others
  bool fresh = false;                                // makes all runs anew
  std::function<void(const Progress&)> on_progress;  // after each run
};

struct WorkDone {
  Progress progress;
  std::optional<run::Stopped> stopped;  // why it is not complete
};

// Identity of the campaign that a scenario's file and these options make.
Identity identity_of(const config::Node& root, const std::filesystem::path& file,
                     const std::vector<std::string>& words);

// Reads up to 1,000 of the shard's runs, evenly spread, so that mistakes show before the first begins. Throws
// config::ConfigError.
void check_scenarios(const config::Node& root, const Shard& shard);

// `root`: the content of options.file. `results`: opened for this campaign and shard. A campaign in one shard
// ends as soon as it is decided. Throws cli::ExitError where
// results cannot be written; what was written before stays.
WorkDone work(const config::Node& root, const WorkOptions& options, Results& results);

}  // namespace visum::campaign
