// A campaign whose shards are made elsewhere: by a command of the user's, or as an array job of Slurm. Each
// shard is `visum run FILE --shard I/N` with a folder of its own below the campaign's, on a file system that
// all machines share. Main thread.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace visum::campaign {

struct RemoteOptions {
  std::filesystem::path file;      // the scenario
  std::filesystem::path folder;    // of the campaign; shards go to FOLDER/shards/I
  std::vector<std::string> words;  // further options of each shard
  std::size_t runs = 1;            // of the whole campaign
  std::size_t shards = 1;
  std::size_t tries = 3;   // of a shard that ends without all its runs
  double timeout_s = 1e6;  // wall time for all
  // For the shell: a command with {command}, {shard} and {shards} in it. How many at a time.
  std::string command{};
  std::size_t at_once = 1;
  std::vector<std::string> sbatch{};  // further options for Slurm's sbatch
  std::function<void(const std::string&)> on_news{};
  std::function<void()> on_round{};  // called every other second or so while shards are made
};

std::vector<std::filesystem::path> shard_folders(const RemoteOptions& options);

// Return when all shards are complete. A shard that is complete already is not started. Throw cli::ExitError:
// kInvalid where one is not complete after all tries, kUsage or kBadConfig where `visum run` says so,
// kTimedOut, kInterrupted. What was finished stays in the folders.
void run_by_shell(const RemoteOptions& options);
void run_by_slurm(const RemoteOptions& options);

}  // namespace visum::campaign
