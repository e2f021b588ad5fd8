// Puts the results of shards together.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "clients/visum/campaign/summary.h"

namespace visum::campaign {

struct Merged {
  std::size_t runs = 0;
  std::vector<std::size_t> missing, doubled;  // runs; at most Results::kMostListed
  std::vector<std::string> foreign;           // what does not belong to the first folder's campaign, and why
  Summary summary;
  bool good() const { return missing.empty() && doubled.empty() && foreign.empty(); }
};

// Writes the results of all shards to the folder `out`, with reports. Where something is missing, doubled or
// foreign, nothing is written. Throws cli::ExitError where a folder holds no results, or `out` holds other
// ones and `replaces` is false.
Merged merge(const std::vector<std::filesystem::path>& shards, const std::filesystem::path& out,
             bool replaces = false);

}  // namespace visum::campaign
