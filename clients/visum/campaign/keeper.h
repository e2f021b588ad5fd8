// Keeps the results of runs, and finds those that need not be made again. One thread.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "clients/visum/campaign/content_key.h"
#include "clients/visum/campaign/results.h"
#include "clients/visum/run/report.h"
#include "clients/visum/run/sweep.h"
#include "protocol/config/config.h"

namespace visum::campaign {

struct KeeperOptions {
  std::filesystem::path folder;    // of the results
  std::vector<std::string> words;  // options of each run
  bool records = true;             // a failed run is known only where its recording is there
  bool records_all = false;        // so is any other
  bool fresh = false;              // nothing is known
};

class Keeper {
 public:
  // `root`: the scenario's file. It and the results must outlive the keeper.
  Keeper(const config::Node& root, KeeperOptions options, Results& results);

  // Returns the kept run at that point; nothing: it must be made. Throws config::ConfigError where the
  // scenario is wrong with these values.
  std::optional<Row> find(std::size_t run, const run::SweepPoint& point);
  // Writes a run that was made, or that could not be read. Throws cli::ExitError.
  Row keep(std::size_t run, const run::SweepPoint& point, const run::Report& report);

 private:
  std::optional<Row> reusable(const run::Scenario& scenario, std::size_t run, const std::string& key,
                              const std::string& parameters);

  const config::Node& root_;
  const KeeperOptions options_;
  Results& results_;
  ContentKeys keys_;
  std::map<std::size_t, std::string> keys_of_;  // of runs that find() did not know
  const std::string host_;
};

// {"mass":"0.2"}
std::string as_json(const run::SweepPoint& point);

}  // namespace visum::campaign
