// The work that `visum campaign` and `visum run --shard` share: makes the runs, shows progress, writes
// reports.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clients/visum/campaign/remote.h"
#include "clients/visum/campaign/shard.h"
#include "clients/visum/common/exit_code.h"
#include "protocol/config/config.h"

namespace visum::cli {

struct CampaignWords {
  std::string file;                // the scenario
  std::string folder;              // for results and reports
  std::vector<std::string> words;  // options that each run gets too
  campaign::Shard shard;
  std::size_t jobs = 1;  // runs at a time; 0: as many as there are processors
  bool json = false, fresh = false, records = true, records_all = false;
};

// `root`: the content of the file. Returns the exit code. Throws ExitError and config::ConfigError.
int run_campaign(const CampaignWords& wanted, const config::Node& root);

// Has the shards made elsewhere, and merges them; a search is made here. `on`: "shell" or "slurm". Returns
// the exit code.
int run_campaign_elsewhere(const std::string& on, campaign::RemoteOptions remote, const CampaignWords& wanted,
                           const config::Node& root);

}  // namespace visum::cli
