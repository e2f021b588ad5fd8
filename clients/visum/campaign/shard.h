// A share of a campaign's runs, for one machine or one task of a cluster. Pure, but for the environment that
// from_environment() is given.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace visum::campaign {

// Run k belongs to shard (k - 1) % count + 1.
struct Shard {
  std::size_t index = 1;  // from 1
  std::size_t count = 1;

  bool operator==(const Shard&) const = default;
  std::size_t first() const { return index; }  // run
  bool holds(std::size_t run) const { return (run - 1) % count + 1 == index; }
  std::size_t runs(std::size_t all) const { return index > all ? 0 : (all - index) / count + 1; }
  std::string text() const { return std::to_string(index) + "/" + std::to_string(count); }
};

// Reads "3/100". Throws cli::ExitError(kUsage), with `source` in its text.
Shard shard_of(const std::string& text, const std::string& source = "--shard");

// As the tools of clusters tell their tasks: VISUM_SHARD=I/N; else a Slurm array (SLURM_ARRAY_TASK_ID, _MIN,
// _COUNT); else a Kubernetes Indexed Job (JOB_COMPLETION_INDEX) with VISUM_SHARD_COUNT. `variable` returns
// the value, or nullptr. Throws cli::ExitError(kUsage) where none of them is set, or one says nonsense.
Shard shard_from(const std::function<const char*(const char*)>& variable);

}  // namespace visum::campaign
