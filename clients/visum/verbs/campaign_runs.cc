#include "clients/visum/verbs/campaign_runs.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "clients/visum/campaign/merge.h"
#include "clients/visum/campaign/results.h"
#include "clients/visum/campaign/summary.h"
#include "clients/visum/campaign/work.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/run/sweep.h"

namespace visum::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string time_text(double seconds) {
  if (seconds < 90.0) return fixed(seconds, 0) + " s";
  if (seconds < 5400.0) return fixed(seconds / 60.0, 0) + " min";
  return fixed(seconds / 3600.0, 1) + " h";
}

// Says how far the work is: often on a terminal, where one line is written again and again, else every 10 s.
class ProgressLine {
 public:
  void show(const campaign::Progress& now) {
    const double period_s = terminal_ ? 0.2 : 10.0;
    if (seconds_since(told_) < period_s && now.done != now.all) return;
    told_ = Clock::now();
    const double made = static_cast<double>(now.done - now.reused);
    const double rate = made / std::max(seconds_since(began_), 1e-3);
    std::string text = std::to_string(now.done) + " of " + std::to_string(now.all) + " runs, " +
                       std::to_string(now.failed) + " failed, " + std::to_string(now.invalid) + " invalid";
    if (now.reused > 0) text += ", " + std::to_string(now.reused) + " were there already";
    if (made > 0.0)
      text += "; " + rounded(rate, 3) + " runs/s, about " +
              time_text(static_cast<double>(now.all - now.done) / rate) + " left";
    std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", text.c_str());
    std::fflush(stderr);
  }
  void end() const {
    if (terminal_) std::fputs("\r\033[K", stderr);
  }

 private:
  const bool terminal_ = ::isatty(STDERR_FILENO) != 0;
  const Clock::time_point began_ = Clock::now();
  Clock::time_point told_ = began_;
};

}  // namespace

int run_campaign(const CampaignWords& wanted, const config::Node& root) {
  campaign::check_scenarios(root, wanted.shard);
  catch_interrupts();
  campaign::Results results(wanted.folder, campaign::identity_of(root, wanted.file, wanted.words),
                            wanted.shard);
  campaign::WorkOptions options{wanted.file, wanted.folder, wanted.words};
  options.jobs = wanted.jobs != 0 ? wanted.jobs : std::max(1U, std::thread::hardware_concurrency());
  options.shard = wanted.shard;
  options.records = wanted.records;
  options.fresh = wanted.fresh;
  ProgressLine line;
  options.on_progress = [&](const campaign::Progress& now) { line.show(now); };
  const auto done = campaign::work(root, options, results);
  line.end();
  if (!done.stopped) results.forget_earlier();
  auto summary = campaign::summarize(results);
  summary.reused = done.progress.reused;
  campaign::write_reports(results, summary, wanted.folder);
  results.close();
  std::FILE* people = wanted.json ? stderr : stdout;
  std::fputs(campaign::summary_text(summary).c_str(), people);
  if (wanted.json) std::printf("%s\n", campaign::summary_json(summary).c_str());
  if (!done.stopped) return summary.code();
  std::fprintf(stderr, "visum: ended before run %zu: %s\n", done.stopped->run, done.stopped->why.c_str());
  return done.stopped->code;
}

int run_campaign_elsewhere(const std::string& on, campaign::RemoteOptions options, const config::Node& root,
                           bool json) {
  options.runs = run::Sweep(root).runs();
  if (options.shards > options.runs) options.shards = options.runs;
  campaign::check_scenarios(root, {});
  catch_interrupts();
  options.on_news = [](const std::string& news) { std::fprintf(stderr, "%s\n", news.c_str()); };
  on == "slurm" ? campaign::run_by_slurm(options) : campaign::run_by_shell(options);
  const auto folders = campaign::shard_folders(options);
  auto merged = campaign::merge(folders, options.folder, true);
  for (const auto& foreign : merged.foreign) std::fprintf(stderr, "visum: %s\n", foreign.c_str());
  for (const auto& folder : folders)
    merged.summary.reused +=
        static_cast<std::size_t>(config::load_file(folder / "summary.json").get("reused").integer(0));
  std::fputs(campaign::summary_text(merged.summary).c_str(), json ? stderr : stdout);
  if (json) std::printf("%s\n", campaign::summary_json(merged.summary).c_str());
  return merged.good() ? merged.summary.code() : kInvalid;
}

}  // namespace visum::cli
