#include "clients/visum/run/many.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <system_error>
#include <utility>

#include "clients/visum/common/format.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/temp_folder.h"
#include "clients/visum/run/reports.h"
#include "clients/visum/run/spare_recording.h"
#include "clients/visum/run/wait_loop.h"
#include "clients/visum/run/worker.h"
#include "protocol/config/config.h"

namespace visum::run {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kRound{100};
constexpr milliseconds kFarewellOfRun{15'000};  // time for a run to end its controllers and its daemon
constexpr double kNoLimit_s = 1e7;              // each run has a limit of its own
constexpr std::size_t kRunsOfAWorker = 1000;    // so that a leak, if there is one, stays small

// "007" of 120, so that names sort as numbers do.
std::string padded(std::size_t run, std::size_t runs) {
  std::string number = std::to_string(run);
  const std::size_t width = std::to_string(runs).size();
  return std::string(width - std::min(width, number.size()), '0') + number;
}

// A worker, and the run that it makes just now; 0: none.
struct Job {
  std::size_t run = 0;
  std::filesystem::path result{};
  std::unique_ptr<SpareRecording> recording{};
  std::unique_ptr<Worker> worker{};
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
      for (;;) {
        while (next_ != 0 && busy() < options_.jobs) start();
        if (busy() == 0) break;
        wait_loop_.wait_for_ends(kRound);
        for (Job& job : jobs_) take_end(job);
        std::erase_if(jobs_, [](const Job& job) { return !job.worker; });
      }
    } catch (const cli::ExitError& error) {
      if (!stopped_ && next_ != 0) stopped_ = Stopped{next_, error.code(), error.what()};
    }
    end_all();
    return stopped_;
  }

 private:
  std::size_t busy() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(jobs_, [](const Job& job) { return job.run != 0; }));
  }

  void start() {
    const std::size_t run = next_;
    Job* const job = idle_job();
    if (job == nullptr) return;
    job->run = run;
    job->result = results_.path() / (std::to_string(run) + ".json");
    if (!options_.recordings.empty()) job->recording = make_recording(run);
    job->worker->give({run, options_.values ? options_.values(run) : std::string(), job->result,
                       job->recording ? job->recording->path() : std::filesystem::path()});
    next_ = options_.next();
  }

  // One that waits for work, or a new one. Null if it cannot be started: then no further run begins.
  Job* idle_job() {
    const auto idle = std::ranges::find(jobs_, std::size_t{0}, &Job::run);
    if (idle != jobs_.end()) return &*idle;
    std::vector<std::string> words{options_.program, "run", options_.file, "--worker", "--recordings", "off"};
    words.insert(words.end(), options_.words.begin(), options_.words.end());
    try {
      Job& job = jobs_.emplace_back();
      job.worker = std::make_unique<Worker>(words);
      wait_loop_.watch(job.worker->process());
      return &job;
    } catch (const std::runtime_error& error) {
      jobs_.pop_back();
      stopped_ = Stopped{next_, cli::kFailed, error.what()};
      next_ = 0;
      return nullptr;
    }
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

  // Hands on the report of a run that is over. A worker that has ended, or has made many runs, goes.
  void take_end(Job& job) {
    processes::ChildProcess& process = job.worker->process();
    const bool gone = process.check_exit().has_value();
    if (job.run != 0 && (gone || job.worker->has_done())) {
      Report report;
      try {
        report = read_report(job.result);
      } catch (const config::ConfigError&) {
        report = lost_report(job);
      }
      std::error_code ignored;
      std::filesystem::remove(job.result, ignored);
      if (job.recording && (options_.keeps_all || !report.passed()))
        report.recording = job.recording->keep().string();
      else if (job.recording)
        report.recording.clear();
      job.recording.reset();
      report.words = options_.words;
      const std::size_t run = std::exchange(job.run, 0);
      if (options_.on_done) options_.on_done(run, report);
    }
    if (gone || (job.run == 0 && job.worker->tasks_given() >= kRunsOfAWorker)) dismiss(job);
  }

  void dismiss(Job& job) {
    job.worker->give_no_more();
    wait_loop_.forget(job.worker->process());
    job.worker->process().stop(kFarewellOfRun);
    job.worker.reset();
  }

  // The report of a run whose process ended without writing one: it holds the last lines of its output.
  Report lost_report(const Job& job) const {
    Report report = report_of(options_, job.run);
    const auto& exit = job.worker->process().check_exit();
    // It refuses its options or the scenario. Any other end, as by a full disk, says nothing about the run.
    const bool told =
        exit && !exit->by_signal && (exit->number == cli::kUsage || exit->number == cli::kBadConfig);
    report.code = cli::interrupted() ? cli::kInterrupted
                  : told             ? static_cast<cli::ExitCode>(exit->number)
                                     : cli::kInvalid;
    report.error = exit ? "the run's process " + exit->text() : "the run's process left no report";
    for (const auto& line : job.worker->process().last_lines()) report.error += "\n" + line;
    return report;
  }

  void end_all() {
    for (Job& job : jobs_) {
      job.worker->give_no_more();
      job.worker->process().signal(SIGINT);
    }
    for (Job& job : jobs_) {
      job.worker->process().stop(kFarewellOfRun);
      take_end(job);
    }
    jobs_.clear();
  }

  const ManyOptions& options_;
  const cli::TempFolder results_;
  WaitLoop wait_loop_{kNoLimit_s};
  std::size_t next_ = options_.next();  // 0: none is left
  std::optional<Stopped> stopped_;
  std::vector<Job> jobs_;  // at most as many as options_.jobs
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
