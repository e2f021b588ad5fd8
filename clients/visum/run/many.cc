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

class Crew {
 public:
  explicit Crew(const ManyOptions& options) : options_(options), reports_(options.runs) {}

  std::vector<Report> work() {
    try {
      while (begun_ < options_.runs || !jobs_.empty()) {
        while (begun_ < options_.runs && jobs_.size() < options_.jobs) start(++begun_);
        wait_loop_.wait(-1, kRound);
        std::erase_if(jobs_, [this](Job& job) { return take_end(job); });
      }
    } catch (const cli::ExitError& error) {
      end_all();
      leave_out_from(begun_ + 1, error.code(), error.what());
    }
    return std::move(reports_);
  }

 private:
  void start(std::size_t run) {
    Job job;
    job.run = run;
    job.result = results_.path() / (std::to_string(run) + ".json");
    if (!options_.recordings.empty()) job.recording = make_recording(run);
    std::vector<std::string> words{
        options_.program, "run",      options_.file,  "--only", std::to_string(run),
        "--result",       job.result, "--recordings", "off"};
    if (job.recording) words.insert(words.end(), {"--try-record", job.recording->path()});
    words.insert(words.end(), options_.words.begin(), options_.words.end());
    try {
      job.process = std::make_unique<ChildProcess>("run " + std::to_string(run), words,
                                                   ChildProcess::OnLine{}, ChildProcess::OnLine{});
    } catch (const std::runtime_error& error) {
      return leave_out_from(run, cli::kFailed, error.what());
    }
    wait_loop_.watch(*job.process);
    jobs_.push_back(std::move(job));
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
    Report& report = reports_[job.run - 1];
    try {
      report = read_report(job.result);
    } catch (const config::ConfigError&) {
      report = lost_report(job, *exit);
    }
    std::error_code ignored;
    std::filesystem::remove(job.result, ignored);
    if (job.recording) report.recording = report.passed() ? std::string() : job.recording->keep().string();
    report.words = options_.words;
    if (options_.on_done) options_.on_done(report);
    return true;
  }

  Report report_of(std::size_t run) const {
    Report report;
    report.name = report.file = options_.file.string();
    report.run = run;
    report.words = options_.words;
    return report;
  }

  // Reports all runs from this one on as not started; none of them begins.
  void leave_out_from(std::size_t run, cli::ExitCode code, const std::string& why) {
    for (begun_ = options_.runs; run <= options_.runs; ++run) {
      Report& report = reports_[run - 1] = report_of(run);
      report.code = code;
      report.error = "not started: " + why;
    }
  }

  // The report of a run whose process ended without writing one: it holds the last lines of its output.
  Report lost_report(const Job& job, const ExitStatus& exit) const {
    Report report = report_of(job.run);
    const bool told = !exit.by_signal && exit.number != cli::kDone;
    report.code = cli::interrupted() ? cli::kInterrupted
                  : told             ? static_cast<cli::ExitCode>(exit.number)
                                     : cli::kFailed;
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
  std::vector<Report> reports_;
  const cli::TempFolder results_;
  WaitLoop wait_loop_{kNoLimit_s};
  std::size_t begun_ = 0;  // or left out
  std::vector<Job> jobs_;
};

}  // namespace

std::vector<Report> run_many(const ManyOptions& options) {
  return Crew(options).work();
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
