#include "clients/visum/run/run_profile.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "clients/visum/common/format.h"
#include "clients/visum/run/session.h"
#include "protocol/config/config.h"

namespace visum::run {
namespace {

constexpr std::size_t kMostSpans = 1'000'000;
constexpr std::string_view kWaitsFor = "waits for ";  // visumd names whom it waits for

struct Row {
  std::string name;
  std::int64_t ns = 0;
  bool per_tick = true;
  const char* text = "";
};

// The rows of the table for the phases of visumd, in its order.
struct Kind {
  const char* name;
  const char* text;
};
constexpr std::array<Kind, 11> kPhaseKinds{
    {{"controllers", "visumd waits for the next message of a controller"},
     {"runner", "visumd waits for visum run"},
     {"cycle wait", "visumd waits, and nobody holds the world"},
     {"gateway", "reading, answering and sending messages"},
     {"agents", "the scene's own controllers"},
     {"drives", "ramps, limits and motors before the step"},
     {"parts", "sensors, and the parts' outputs after the step"},
     {"collision", "contacts, and fast bodies held back"},
     {"physics", "the engines' step"},
     {"recording", "what is kept of each tick"},
     {"hash", "the state's hash"}}};

std::string row_of(const std::string& phase) {
  if (phase == kWaitsFor.data() + std::string(Session::kName) ||
      phase == kWaitsFor.data() + std::string(Session::kWaiterName))
    return "runner";
  if (phase.starts_with(kWaitsFor)) return "controllers";
  return phase == "wait" ? "cycle wait" : phase;
}

std::vector<config::Node> items(const config::Node& list) {
  std::vector<config::Node> all;
  for (std::size_t i = 0; i < list.size(); ++i) all.push_back(list.at(i));
  return all;
}

// The time in which visumd wrote its trace.
struct Written {
  std::int64_t ns = 0, cpu_us = 0;
};

// By the last line of visumd's file: `],"written":{"ns":5,"cpu_us":3}}`. Without a trace it has no such line.
Written read_written(const std::filesystem::path& daemon_file) {
  constexpr std::streamoff kLongestLine = 128;
  std::ifstream in(daemon_file, std::ios::ate);
  in.seekg(std::max<std::streamoff>(0, in.tellg() - kLongestLine));
  const std::string tail{std::istreambuf_iterator<char>(in), {}};
  const auto at = tail.rfind("],\"written\":");
  if (at == std::string::npos) return {};
  const auto line = config::load_text("{" + tail.substr(at + 2), "visumd's profile").get("written");
  return {line.get("ns").integer(), line.get("cpu_us").integer()};
}

std::vector<Row> rows_of(const config::Node& of_daemon, const Written& written, std::int64_t began_ns,
                         std::int64_t ended_ns) {
  const auto first = of_daemon.get("first_tick_ns").integer(), last = of_daemon.get("last_tick_ns").integer();
  if (first == 0) return {{"all", ended_ns - began_ns, false, "there was no tick"}};
  std::vector<Row> rows{
      {"load", 0, false, "until visumd was ready: its start and the scene"},
      {"start", 0, false, "from there to the first tick: mostly the controllers' own start"}};
  for (const auto& phase : items(of_daemon.get("whole")))
    if (phase.get("name").text() == "load") rows[0].ns = phase.get("ns").integer();
  rows[0].ns += of_daemon.get("began_ns").integer() - began_ns;
  rows[1].ns = first - began_ns - rows[0].ns;
  for (const auto& kind : kPhaseKinds) rows.push_back({kind.name, 0, true, kind.text});
  for (const auto& phase : items(of_daemon.get("run"))) {
    const auto name = row_of(phase.get("name").text());
    const auto found = std::ranges::find(rows, name, &Row::name);
    if (found == rows.end())
      rows.push_back({name, phase.get("ns").integer()});
    else
      found->ns += phase.get("ns").integer();
  }
  rows.push_back({"end", ended_ns - last - written.ns, false, "after the last tick: all processes end"});
  rows.push_back({"trace", written.ns, false, "visumd writes its spans; without a trace it does not"});
  std::erase_if(rows, [](const Row& row) { return row.ns == 0; });
  return rows;
}

double cpu_seconds(int whose) {
  rusage usage{};
  if (::getrusage(whose, &usage) != 0) return 0.0;
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             config::Profile::Clock::now().time_since_epoch())
      .count();
}

}  // namespace

RunProfile::RunProfile(std::filesystem::path trace)
    : trace_(std::move(trace)), runner_(wants_spans() ? kMostSpans : 0) {}

std::string RunProfile::table(const std::string& first_line, std::int64_t ended_ns) const {
  const auto of_daemon = config::load_text(first_line + "]}", "visumd's profile").get("visum");
  const auto written = read_written(daemon_file());
  const auto began_ns = runner_.began_ns();
  const auto ticks = of_daemon.get("ticks").integer();
  const auto total = static_cast<double>(std::max<std::int64_t>(1, ended_ns - began_ns));
  cli::Table table;
  table.row({"phase", "ms/run", "us/tick", "share", ""});
  for (const Row& row : rows_of(of_daemon, written, began_ns, ended_ns)) {
    const auto ns = static_cast<double>(row.ns);
    table.row({row.name, cli::fixed(ns * 1e-6, 1),
               row.per_tick ? cli::fixed(ns * 1e-3 / static_cast<double>(std::max<std::int64_t>(1, ticks)), 2)
                            : std::string("-"),
               cli::fixed(100.0 * ns / total, 1) + " %", row.text});
  }
  table.row({"total", cli::fixed(total * 1e-6, 1), "", "100 %", std::to_string(ticks) + " ticks"});
  std::string text = "profile, by wall time:\n" + table.text("  ");
  const auto writing_s = static_cast<double>(written.cpu_us) * 1e-6;
  const auto others_s = std::max(0.0, cpu_seconds(RUSAGE_CHILDREN) - daemon_s_);
  text += "  processor time: visumd " + cli::fixed(daemon_s_ - writing_s, 3) + " s, controllers " +
          cli::fixed(others_s, 3) + " s, visum run " + cli::fixed(cpu_seconds(RUSAGE_SELF), 3) + " s\n";
  if (const auto left_out = of_daemon.get("left_out").integer(); left_out > 0)
    text += "  the trace leaves out the last " + std::to_string(left_out) + " spans\n";
  return text;
}

std::string RunProfile::finish() {
  const auto ended_ns = steady_ns();
  runner_.enter(config::Profile::kEnd);
  std::ifstream in(daemon_file());
  std::string first_line;
  std::getline(in, first_line);
  if (first_line.empty()) return "profile: visumd has left none\n";
  auto text = table(first_line, ended_ns);
  if (wants_spans()) write_trace();
  return text;
}

// visumd's file is the trace already; ours are events more.
void RunProfile::write_trace() {
  std::ifstream in(daemon_file());
  std::ofstream out(trace_, std::ios::binary | std::ios::trunc);
  std::string first_line;
  std::getline(in, first_line);
  const auto process = static_cast<std::int64_t>(::getpid());
  out << first_line << "\n" << config::name_events(process, "visum run", "main");
  runner_.write_spans(out, process);
  out << in.rdbuf();
  if (!out.flush())
    throw std::runtime_error("--profile " + trace_.string() + ": cannot be written: " + std::strerror(errno));
}

}  // namespace visum::run
