#include "clients/visum/run/many.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <system_error>

#include "clients/visum/common/format.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/temp_folder.h"
#include "clients/visum/run/child_process.h"
#include "clients/visum/run/reports.h"
#include "clients/visum/run/spare_recording.h"
#include "clients/visum/run/wait_loop.h"
#include "protocol/config/config.h"

namespace visum::run {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kRound{100};
constexpr milliseconds kFarewellOfRun{15'000};  // time for a run to end its controllers and its daemon
constexpr double kNoLimit_s = 1e7;              // each run has a limit of its own

// "007" of 120, so that names sort as numbers do.
std::string padded(std::size_t run, std::size_t runs) {
  std::string number = std::to_string(run);
  const std::size_t width = std::to_string(runs).size();
  return std::string(width - std::min(width, number.size()), '0') + number;
}

struct Job {
  std::size_t run = 0;
  std::filesystem::path result;
  std::unique_ptr<SpareRecording> recording;
  std::unique_ptr<ChildProcess> process;
};

Report report_of(const ManyOptions& options, std::size_t run) {
  Report report;
  report.name = report.file = options.file.string();
  report.run = run;
  report.words = options.words;
  return report;
}

class Crew {
 public:
  explicit Crew(const ManyOptions& options) : options_(options) {}

  std::optional<Stopped> work() {
    try {
      while (next_ != 0 || !jobs_.empty()) {
        while (next_ != 0 && jobs_.size() < options_.jobs) start();
        wait_loop_.wait_for_ends(kRound);
        std::erase_if(jobs_, [this](Job& job) { return take_end(job); });
      }
    } catch (const cli::ExitError& error) {
      if (!stopped_ && next_ != 0) stopped_ = Stopped{next_, error.code(), error.what()};
      end_all();
    }
    return stopped_;
  }

 private:
  void start() {
    const std::size_t run = next_;
    Job job;
    job.run = run;
    job.result = results_.path() / (std::to_string(run) + ".json");
    if (!options_.recordings.empty()) job.recording = make_recording(run);
    std::vector<std::string> words{
        options_.program, "run",      options_.file,  "--only", std::to_string(run),
        "--result",       job.result, "--recordings", "off"};
    if (options_.values) words.insert(words.end(), {"--values", options_.values(run)});
    if (job.recording) words.insert(words.end(), {"--try-record", job.recording->path()});
    words.insert(words.end(), options_.words.begin(), options_.words.end());
    try {
      job.process = std::make_unique<ChildProcess>("run " + std::to_string(run), words,
                                                   ChildProcess::OnLine{}, ChildProcess::OnLine{});
    } catch (const std::runtime_error& error) {
      stopped_ = Stopped{run, cli::kFailed, error.what()};
      next_ = 0;
      return;
    }
    wait_loop_.watch(*job.process);
    jobs_.push_back(std::move(job));
    next_ = options_.next();
  }

  std::unique_ptr<SpareRecording> make_recording(std::size_t run) const {
    const auto name = "run_" + padded(run, options_.runs) + ".mcap";
    try {
      return std::make_unique<SpareRecording>(options_.recordings / name);
    } catch (const std::system_error& error) {
      std::fprintf(stderr, "visum: if run %zu fails, it leaves no recording: %s\n", run, error.what());
      return nullptr;
    }
  }

  bool take_end(Job& job) {
    const auto& exit = job.process->check_exit();
    if (!exit) return false;
    wait_loop_.forget(*job.process);
    Report report;
    try {
      report = read_report(job.result);
    } catch (const config::ConfigError&) {
      report = lost_report(job, *exit);
    }
    std::error_code ignored;
    std::filesystem::remove(job.result, ignored);
    if (job.recording && (options_.keeps_all || !report.passed()))
      report.recording = job.recording->keep().string();
    else if (job.recording)
      report.recording.clear();
    report.words = options_.words;
    if (options_.on_done) options_.on_done(job.run, report);
    return true;
  }

  // The report of a run whose process ended without writing one: it holds the last lines of its output.
  Report lost_report(const Job& job, const ExitStatus& exit) const {
    Report report = report_of(options_, job.run);
    // Somebody killed it, or it ended well without a report: that says nothing about the run.
    const bool told = !exit.by_signal && exit.number != cli::kDone;
    report.code = cli::interrupted() ? cli::kInterrupted
                  : told             ? static_cast<cli::ExitCode>(exit.number)
                                     : cli::kInvalid;
    report.error = "the run's process " + exit.text();
    for (const auto& line : job.process->last_lines()) report.error += "\n" + line;
    return report;
  }

  void end_all() {
    for (const Job& job : jobs_) job.process->signal(SIGINT);
    for (Job& job : jobs_) {
      job.process->stop(kFarewellOfRun);
      take_end(job);
    }
    jobs_.clear();
  }

  const ManyOptions& options_;
  const cli::TempFolder results_;
  WaitLoop wait_loop_{kNoLimit_s};
  std::size_t next_ = options_.next();  // 0: none is left
  std::optional<Stopped> stopped_;
  std::vector<Job> jobs_;
};

}  // namespace

std::optional<Stopped> run_each(const ManyOptions& options) {
  return Crew(options).work();
}

std::vector<Report> run_many(const ManyOptions& options) {
  std::vector<Report> reports(options.runs);
  ManyOptions each = options;
  each.next = [begun = std::size_t{0}, all = options.runs]() mutable { return begun < all ? ++begun : 0; };
  each.on_done = [&](std::size_t run, const Report& report) {
    reports[run - 1] = report;
    if (options.on_done) options.on_done(run, report);
  };
  const auto stopped = run_each(each);
  for (std::size_t run = stopped ? stopped->run : options.runs + 1; run <= options.runs; ++run) {
    Report& report = reports[run - 1] = report_of(options, run);
    report.code = stopped->code;
    report.error = "not started: " + stopped->why;
  }
  return reports;
}

cli::ExitCode code_of(const std::vector<Report>& reports) {
  const auto any = [&](cli::ExitCode code) {
    return std::ranges::any_of(reports, [&](const Report& report) { return report.code == code; });
  };
  for (const auto code : {cli::kInterrupted, cli::kBadConfig, cli::kUsage, cli::kTimedOut, cli::kLost})
    if (any(code)) return code;
  if (std::ranges::all_of(reports, &Report::passed)) return cli::kDone;
  return any(cli::kInvalid) && !any(cli::kFailed) ? cli::kInvalid : cli::kFailed;
}

}  // namespace visum::run
