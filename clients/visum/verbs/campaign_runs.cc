#include "clients/visum/verbs/campaign_runs.h"

#include <algorithm>
#include <cstdio>
#include <thread>

#include "clients/visum/campaign/merge.h"
#include "clients/visum/campaign/progress.h"
#include "clients/visum/campaign/results.h"
#include "clients/visum/campaign/summary.h"
#include "clients/visum/campaign/work.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/run/search_spec.h"
#include "clients/visum/run/sweep.h"

namespace visum::cli {
namespace {

// As the shards have told it.
campaign::Progress progress_of(const campaign::RemoteOptions& remote) {
  campaign::Progress all;
  for (const auto& folder : campaign::shard_folders(remote)) {
    const auto one = campaign::read_progress(folder);
    if (!one) continue;
    all.done += one->done;
    all.passed += one->passed;
    all.failed += one->failed;
    all.invalid += one->invalid;
    all.reused += one->reused;
  }
  all.all = remote.runs;
  return all;
}

std::size_t jobs_of(std::size_t wanted) {
  return wanted != 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

// Judges what is there, searches where the scenario asks for it, writes the reports and tells. Returns the
// exit code.
int conclude(const config::Node& root, const campaign::WorkOptions& options, campaign::Results& results,
             campaign::ProgressBoard& board, std::size_t reused, std::optional<run::Stopped> stopped,
             bool json) {
  auto summary = campaign::summarize(results);
  summary.reused = reused;
  const auto wanted = run::read_search(root);
  if (wanted && !stopped && options.shard.count == 1) {
    const std::size_t last = summary.decided_at != 0 ? summary.decided_at : summary.all;
    summary.search = campaign::search(root, *wanted, options, results, last);
    stopped = summary.search->stopped;
  }
  board.end();
  if (!stopped) results.forget_earlier();
  campaign::write_reports(results, summary, options.folder);
  results.close();
  std::fputs(campaign::summary_text(summary).c_str(), json ? stderr : stdout);
  if (json) std::printf("%s\n", campaign::summary_json(summary).c_str());
  if (!stopped) return summary.code();
  std::fprintf(stderr, "visum: ended before run %zu: %s\n", stopped->run, stopped->why.c_str());
  // A process that could not be started is no verdict.
  return stopped->code == kFailed ? kInvalid : stopped->code;
}

}  // namespace

int run_campaign(const CampaignWords& wanted, const config::Node& root) {
  campaign::check_scenarios(root, wanted.shard);
  catch_interrupts();
  campaign::Results results(wanted.folder, campaign::identity_of(root, wanted.file, wanted.words),
                            wanted.shard);
  campaign::WorkOptions options{wanted.file, wanted.folder, wanted.words};
  options.jobs = jobs_of(wanted.jobs);
  options.shard = wanted.shard;
  options.records = wanted.records;
  options.fresh = wanted.fresh;
  options.records_all = wanted.records_all;
  campaign::ProgressBoard board(wanted.folder, root.get("name").text());
  options.on_progress = [&](const campaign::Progress& now) { board.show(now); };
  const auto done = campaign::work(root, options, results);
  return conclude(root, options, results, board, done.progress.reused, done.stopped, wanted.json);
}

int run_campaign_elsewhere(const std::string& on, campaign::RemoteOptions remote, const CampaignWords& wanted,
                           const config::Node& root) {
  remote.runs = run::Sweep(root).runs();
  if (remote.shards > remote.runs) remote.shards = remote.runs;
  campaign::check_scenarios(root, {});
  catch_interrupts();
  remote.on_news = [](const std::string& news) { std::fprintf(stderr, "%s\n", news.c_str()); };
  campaign::ProgressBoard board(wanted.folder, root.get("name").text());
  remote.on_round = [&] { board.show(progress_of(remote)); };
  on == "slurm" ? campaign::run_by_slurm(remote) : campaign::run_by_shell(remote);
  const auto folders = campaign::shard_folders(remote);
  const auto merged = campaign::merge(folders, wanted.folder, true);
  for (const auto& foreign : merged.foreign) std::fprintf(stderr, "visum: %s\n", foreign.c_str());
  if (!merged.good()) return kInvalid;
  std::size_t reused = 0;
  for (const auto& folder : folders)
    reused += static_cast<std::size_t>(config::load_file(folder / "summary.json").get("reused").integer(0));
  // A search needs few runs at a time, each of which needs those before: it is made here.
  campaign::Results results(wanted.folder, campaign::identity_of(root, wanted.file, wanted.words), {});
  campaign::WorkOptions options{wanted.file, wanted.folder, wanted.words, jobs_of(wanted.jobs)};
  options.records = wanted.records;
  options.records_all = wanted.records_all;
  options.on_progress = [&](const campaign::Progress& now) { board.show(now); };
  return conclude(root, options, results, board, reused, {}, wanted.json);
}

}  // namespace visum::cli
