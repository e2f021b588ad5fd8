#include "clients/visum/campaign/remote.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <system_error>

#include "clients/visum/campaign/results.h"
#include "clients/visum/campaign/shard.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/shell_word.h"
#include "clients/visum/common/whole_file.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/wait_loop.h"
#include "protocol/processes/child_process.h"

namespace visum::campaign {
namespace {

using cli::shell_word;
using std::chrono::milliseconds;

constexpr milliseconds kRound{500};
constexpr std::chrono::seconds kLook{2};  // how often the shards' progress is read
constexpr milliseconds kFarewell{20'000};

std::filesystem::path folder_of(const RemoteOptions& options, std::size_t shard) {
  return std::filesystem::absolute(options.folder / "shards" / std::to_string(shard)).lexically_normal();
}

// The command of a shard, without the shard itself.
std::string command_of(const RemoteOptions& options) {
  std::string text = shell_word((run::own_folder() / "visum").string()) + " run " +
                     shell_word(std::filesystem::absolute(options.file).lexically_normal().string());
  for (const auto& word : options.words) text += " " + shell_word(word);
  return text;
}

// Returns true if all runs of a shard are there.
bool is_complete(const RemoteOptions& options, std::size_t shard) {
  std::error_code none;
  const auto folder = folder_of(options, shard);
  if (!std::filesystem::exists(folder / Results::kFile, none)) return false;
  try {
    Results results(folder);
    const Shard wanted{shard, options.shards};
    if (!(results.shard() == wanted) || results.identity().runs != options.runs) return false;
    std::size_t there = 0;
    results.for_each(options.runs, [&](const Row&) { ++there; });
    return there == wanted.runs(options.runs);
  } catch (const cli::ExitError&) {  // somebody writes to it, or it is no database
    return false;
  }
}

std::vector<std::size_t> incomplete(const RemoteOptions& options) {
  std::vector<std::size_t> shards;
  for (std::size_t shard = 1; shard <= options.shards; ++shard)
    if (!is_complete(options, shard)) shards.push_back(shard);
  return shards;
}

std::string list_of(const std::vector<std::size_t>& shards) {
  std::string text;
  for (const std::size_t shard : shards) text += (text.empty() ? "" : ",") + std::to_string(shard);
  return text;
}

std::string last_lines(const processes::ChildProcess& process) {
  std::string text;
  for (const auto& line : process.last_lines()) text += "\n" + line;
  return text;
}

std::string filled(std::string text, const std::string& name, const std::string& value) {
  for (std::size_t at = 0; (at = text.find(name, at)) != text.npos; at += value.size())
    text.replace(at, name.size(), value);
  return text;
}

// Tells when it is time for on_round.
class Rounds {
 public:
  explicit Rounds(const RemoteOptions& options) : options_(options) {}
  void pass() {
    if (!options_.on_round || Clock::now() < next_) return;
    options_.on_round();
    next_ = Clock::now() + kLook;
  }

 private:
  using Clock = std::chrono::steady_clock;
  const RemoteOptions& options_;
  Clock::time_point next_ = Clock::now() + kLook;
};

[[noreturn]] void give_up(const RemoteOptions& options, const std::vector<std::size_t>& shards,
                          const std::string& why) {
  throw cli::ExitError(cli::kInvalid, "shards " + list_of(shards) + " of " + std::to_string(options.shards) +
                                          " are not complete after " + std::to_string(options.tries) +
                                          " tries; what they have done is kept: call again" + why);
}

// Commands of the user's, several at a time.
class Shell {
 public:
  explicit Shell(const RemoteOptions& options) : options_(options), wait_loop_(options.timeout_s) {}

  void go() {
    for (const std::size_t shard : incomplete(options_)) waiting_.push_back({shard, 0, nullptr});
    std::reverse(waiting_.begin(), waiting_.end());
    while (!waiting_.empty() || !jobs_.empty()) {
      while (!waiting_.empty() && jobs_.size() < options_.at_once) start();
      wait_loop_.wait_for_ends(kRound);
      rounds_.pass();
      for (std::size_t i = jobs_.size(); i-- > 0;)
        if (has_ended(jobs_[i])) jobs_.erase(jobs_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  ~Shell() {
    for (const Job& job : jobs_) job.process->signal(SIGINT);
    for (const Job& job : jobs_) job.process->stop(kFarewell);
  }

 private:
  struct Job {
    std::size_t shard = 0, tried = 0;
    std::unique_ptr<processes::ChildProcess> process;
  };

  void start() {
    Job job = std::move(waiting_.back());
    waiting_.pop_back();
    ++job.tried;
    const std::string shard = std::to_string(job.shard), shards = std::to_string(options_.shards);
    std::string text = filled(options_.command, "{shards}", shards);
    text = filled(text, "{shard}", shard);
    text = filled(text, "{command}",
                  command_of(options_) + " --shard " + shard + "/" + shards + " --report " +
                      shell_word(folder_of(options_, job.shard).string()));
    job.process = std::make_unique<processes::ChildProcess>(
        "shard " + shard, std::vector<std::string>{"/bin/sh", "-c", text}, processes::ChildProcess::OnLine{},
        processes::ChildProcess::OnLine{});
    wait_loop_.watch(*job.process);
    jobs_.push_back(std::move(job));
  }

  bool has_ended(Job& job) {
    const auto exit = job.process->check_exit();
    if (!exit) return false;
    wait_loop_.forget(*job.process);
    const std::string name = "shard " + Shard{job.shard, options_.shards}.text();
    if (is_complete(options_, job.shard)) {
      options_.on_news(name + " is done");
      return true;
    }
    const std::string how = name + ": its command " + exit->text() + last_lines(*job.process);
    if (!exit->by_signal && (exit->number == cli::kUsage || exit->number == cli::kBadConfig))
      throw cli::ExitError(static_cast<cli::ExitCode>(exit->number), how);
    if (job.tried >= options_.tries) give_up(options_, {job.shard}, "\n" + how);
    options_.on_news(how + "\n" + name + " is tried again");
    waiting_.push_back({job.shard, job.tried, nullptr});
    return true;
  }

  const RemoteOptions& options_;
  run::WaitLoop wait_loop_;
  Rounds rounds_{options_};
  std::vector<Job> waiting_, jobs_;
};

// A job script for the array, which `sbatch` gets as it is.
std::filesystem::path write_script(const RemoteOptions& options) {
  const auto folder = std::filesystem::absolute(options.folder / "shards").lexically_normal();
  std::filesystem::create_directories(folder);
  const std::string text =
      "#!/bin/sh\n"
      "#SBATCH --requeue\n"
      "#SBATCH --open-mode=append\n"
      "export VISUM_SHARD=$SLURM_ARRAY_TASK_ID/" +
      std::to_string(options.shards) + "\nexec " + command_of(options) + " --shard --report " +
      shell_word(folder.string()) + "/$SLURM_ARRAY_TASK_ID\n";
  cli::write_whole_file(folder / "job.sh", text);
  return folder / "job.sh";
}

}  // namespace

std::vector<std::filesystem::path> shard_folders(const RemoteOptions& options) {
  std::vector<std::filesystem::path> folders;
  for (std::size_t shard = 1; shard <= options.shards; ++shard) folders.push_back(folder_of(options, shard));
  return folders;
}

void run_by_shell(const RemoteOptions& options) {
  Shell(options).go();
}

void run_by_slurm(const RemoteOptions& options) {
  const auto script = write_script(options);
  run::WaitLoop wait_loop(options.timeout_s);
  Rounds rounds(options);
  std::string trouble;
  for (std::size_t tried = 0; tried < options.tries; ++tried) {
    const auto shards = incomplete(options);
    if (shards.empty()) return;
    std::vector<std::string> words{"sbatch",
                                   "--wait",
                                   "--parsable",
                                   "--array=" + list_of(shards),
                                   "--job-name=visum-campaign",
                                   "--output=" + (script.parent_path() / "%a.log").string()};
    words.insert(words.end(), options.sbatch.begin(), options.sbatch.end());
    words.push_back(script.string());
    std::string job;
    processes::ChildProcess sbatch("sbatch", words,
                                   [&](const std::string& line) {
                                     if (job.empty()) job = line.substr(0, line.find(';'));
                                   },
                                   {});
    wait_loop.watch(sbatch);
    try {
      while (!sbatch.check_exit()) {
        wait_loop.wait_for_ends(kRound);
        rounds.pass();
      }
    } catch (...) {
      if (!job.empty()) processes::ChildProcess("scancel", {"scancel", job}, {}, {}).wait_exit(kFarewell);
      throw;
    }
    wait_loop.forget(sbatch);
    trouble = "\nsbatch " + sbatch.check_exit()->text() + last_lines(sbatch);
    if (job.empty()) throw cli::ExitError(cli::kInvalid, "Slurm took no job: " + trouble.substr(1));
    options.on_news("Slurm's job " + job + " has ended; " + std::to_string(shards.size()) +
                    " shards were in it");
  }
  if (const auto shards = incomplete(options); !shards.empty())
    give_up(options, shards, "; their logs: " + (script.parent_path() / "I.log").string() + trouble);
}

}  // namespace visum::campaign
