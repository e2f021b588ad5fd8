#include "clients/visum/campaign/merge.h"

#include <limits>
#include <memory>
#include <system_error>

#include "clients/visum/common/exit_code.h"
#include "protocol/config/new_file.h"

namespace visum::campaign {
namespace {

constexpr std::size_t kMostForeign = 100;

// A folder beside `out`, which becomes it once all is well.
class NewFolder {
 public:
  explicit NewFolder(const std::filesystem::path& out) : path_(out.lexically_normal()) {
    if (!path_.has_filename()) path_ = path_.parent_path();
    path_ = config::name_beside(path_, ".part");
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~NewFolder() {
    std::error_code none;
    std::filesystem::remove_all(path_, none);
  }
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

  void keep(const std::filesystem::path& out) const {
    std::filesystem::create_directories(out);
    for (const auto& file : std::filesystem::directory_iterator(path_))
      std::filesystem::rename(file.path(), out / file.path().filename());
  }

 private:
  std::filesystem::path path_;
};

// The runs of a search stand in no shard. They are kept where they are of the same campaign.
void keep_search(const std::filesystem::path& out, Results& all) {
  std::error_code none;
  if (!std::filesystem::exists(out / Results::kFile, none)) return;
  Results before(out);
  const std::size_t runs = all.identity().runs;
  if (before.identity() == all.identity())
    all.take_over(before, {}, runs + 1, static_cast<std::size_t>(std::numeric_limits<std::int64_t>::max()));
}

}  // namespace

Merged merge(const std::vector<std::filesystem::path>& shards, const std::filesystem::path& out,
             bool replaces) try {
  std::error_code none;
  if (!replaces && std::filesystem::exists(out / Results::kFile, none))
    throw cli::ExitError(cli::kUsage, out.string() + ": holds results already; name another folder");
  const NewFolder folder(out);
  Merged merged;
  std::unique_ptr<Results> all;
  for (const auto& shard : shards) {
    Results one(shard);
    if (!all) {
      all = std::make_unique<Results>(folder.path(), one.identity(), Shard{});
    } else if (const auto why = all->identity().difference(one.identity()); !why.empty()) {
      if (merged.foreign.size() < kMostForeign) merged.foreign.push_back(shard.string() + ": " + why);
      continue;
    }
    const auto from = std::filesystem::absolute(shard).lexically_relative(std::filesystem::absolute(out));
    for (const std::size_t run : all->take_over(one, from, 1, one.identity().runs))
      if (merged.doubled.size() < Results::kMostListed) merged.doubled.push_back(run);
  }
  if (replaces) keep_search(out, *all);
  merged.summary = summarize(*all);
  for (const auto& file : merged.summary.changed)
    merged.foreign.push_back(file + ": not the same for all runs");
  merged.runs = merged.summary.runs;
  merged.missing = merged.summary.missing;
  if (merged.good()) write_reports(*all, merged.summary, folder.path());
  all->close();
  if (merged.good()) folder.keep(out);
  return merged;
} catch (const std::filesystem::filesystem_error& error) {
  throw cli::ExitError(cli::kInvalid, error.what());
}

}  // namespace visum::campaign
