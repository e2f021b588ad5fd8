#include "clients/visum/verbs/run_many.h"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <set>
#include <system_error>
#include <thread>

#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/common/whole_file.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/event_lines.h"
#include "clients/visum/run/many.h"
#include "clients/visum/run/reports.h"
#include "clients/visum/run/scenario_reader.h"
#include "clients/visum/run/sweep.h"

namespace visum::cli {
namespace {

constexpr std::size_t kMostRuns = 10'000;  // reports of all of them are held

// Reads all runs before the first begins, so that a mistake in any of them shows at once. Returns whether the
// scenario itself names files for its recordings.
bool check_runs(const config::Node& root, std::size_t runs) {
  std::set<std::string> recordings;
  for (std::size_t run = 1; run <= runs; ++run) {
    const auto scenario = run::read_scenario(root, run);
    if (scenario.record.empty()) continue;
    if (!recordings.insert(scenario.record).second)
      root.get("record").fail("two runs of the sweep would write '" + scenario.record +
                              "': let ${...} tell them apart, or leave it out and use --report");
  }
  return !recordings.empty();
}

void make_folder(const std::string& folder) {
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  if (error) throw ExitError(kUsage, folder + ": " + error.message());
}

std::size_t count_jobs(std::size_t wanted) {
  return wanted != 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

}  // namespace

void check_writable(const std::string& file) {
  if (file.empty()) return;
  std::ofstream out(file, std::ios::app);
  if (!out) throw ExitError(kUsage, "cannot write " + file + ": " + std::strerror(errno));
}

int run_many(const ManyRunsOptions& wanted, const config::Node& root) {
  const std::size_t runs = run::Sweep(root).runs();
  if (runs > kMostRuns)
    root.get(root.find("sampling") ? "sampling" : "sweep")
        .fail("gives more than " + std::to_string(kMostRuns) + " runs; `visum campaign` takes more");
  const bool recorded = check_runs(root, runs);
  make_folder(wanted.report);
  check_writable(wanted.junit);
  catch_interrupts();
  std::FILE* people = wanted.json || wanted.events ? stderr : stdout;
  const Style style(people);
  run::ManyOptions options{run::own_folder() / "visum", wanted.file, runs, count_jobs(wanted.jobs),
                           wanted.words};
  if (!recorded) options.recordings = wanted.recordings;
  options.keeps_all = wanted.keeps_all;
  make_folder(options.recordings.string());
  options.on_done = [&](std::size_t, const run::Report& report) {
    std::fputs(run::run_line(report, style).c_str(), people);
    if (wanted.json) std::printf("%s\n", run::run_json(report).c_str());
    if (wanted.events) run::EventLines::run(report);
    std::fflush(nullptr);
  };
  if (wanted.events) run::EventLines::begin(root.get("name").text(), runs, 0);
  const auto began = std::chrono::steady_clock::now();
  const auto reports = run::run_many(options);
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const std::filesystem::path folder = wanted.report;
  if (!wanted.report.empty()) write_whole_file(folder / "report.html", run::report_html(reports));
  if (!wanted.report.empty()) write_whole_file(folder / "junit.xml", run::report_junit(reports));
  if (!wanted.junit.empty()) write_whole_file(wanted.junit, run::report_junit(reports));
  std::fputs(run::many_text(reports, wall_s, style).c_str(), people);
  if (wanted.json) std::printf("%s\n", run::many_json(reports, wall_s).c_str());
  if (interrupted()) std::fputs("visum: interrupted\n", stderr);
  const int code = run::code_of(reports);
  if (wanted.events) run::EventLines::end(reports, code);
  return code;
}

}  // namespace visum::cli
