#include "clients/visum/campaign/shard.h"

#include <charconv>
#include <optional>
#include <string_view>

#include "clients/visum/common/exit_code.h"

namespace visum::campaign {
namespace {

constexpr std::size_t kMost = 1'000'000;  // shards

[[noreturn]] void refuse(const std::string& text) {
  throw cli::ExitError(cli::kUsage, text);
}

std::optional<std::size_t> number_in(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::size_t number_of(const char* name, const char* value) {
  if (value == nullptr) refuse(std::string(name) + " is not set");
  const auto number = number_in(value);
  if (!number || *number > kMost)
    refuse(std::string(name) + "=" + value + ": must be a whole number up to " + std::to_string(kMost));
  return *number;
}

}  // namespace

Shard shard_of(const std::string& text, const std::string& source) {
  const auto slash = text.find('/');
  const auto index = number_in(text.substr(0, slash));
  const auto count = slash == text.npos ? std::nullopt : number_in(text.substr(slash + 1));
  if (!index || !count || *index < 1 || *index > *count || *count > kMost)
    refuse(source + ": must be I/N with I from 1 to N, as 3/100; is '" + text + "'");
  return {*index, *count};
}

Shard shard_from(const std::function<const char*(const char*)>& variable) {
  if (const char* text = variable("VISUM_SHARD")) return shard_of(text, "VISUM_SHARD");
  const auto counted = [&](std::size_t index, std::size_t count, const std::string& source) {
    return shard_of(std::to_string(index) + "/" + std::to_string(count), source);
  };
  if (const char* id = variable("SLURM_ARRAY_TASK_ID")) {
    const std::size_t task = number_of("SLURM_ARRAY_TASK_ID", id);
    const std::size_t first = number_of("SLURM_ARRAY_TASK_MIN", variable("SLURM_ARRAY_TASK_MIN"));
    if (task < first) refuse("SLURM_ARRAY_TASK_ID is less than SLURM_ARRAY_TASK_MIN");
    return counted(task - first + 1, number_of("SLURM_ARRAY_TASK_COUNT", variable("SLURM_ARRAY_TASK_COUNT")),
                   "the Slurm array's task (--shard)");
  }
  if (const char* index = variable("JOB_COMPLETION_INDEX"))
    return counted(number_of("JOB_COMPLETION_INDEX", index) + 1,
                   number_of("VISUM_SHARD_COUNT", variable("VISUM_SHARD_COUNT")),
                   "JOB_COMPLETION_INDEX (--shard)");
  refuse(
      "--shard without a value needs VISUM_SHARD=I/N, a Slurm array's task, or JOB_COMPLETION_INDEX and "
      "VISUM_SHARD_COUNT in the environment");
}

}  // namespace visum::campaign
