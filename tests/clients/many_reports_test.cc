// The reports of many runs: what a process writes another reads, and the pages hold what they should.
#include <gmock/gmock.h>
#include <tinyxml2.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>

#include "clients/visum/common/temp_folder.h"
#include "clients/visum/run/many.h"
#include "clients/visum/run/plot.h"
#include "clients/visum/run/reports.h"
#include "protocol/config/config.h"

namespace visum::run {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Report run(std::size_t number, bool passed) {
  Report report;
  report.name = "na<me";
  report.file = "a b.yaml";
  report.scene = "scene.yaml";
  report.clock = "lockstep";
  report.seed = 7;
  report.run = number;
  report.swept = {{"mass", std::to_string(number)}, {"kind", "\"x: <y>\""}};
  report.code = passed ? cli::kDone : cli::kFailed;
  report.ticks = 12000;
  report.sim_seconds = 12.0;
  report.wall_seconds = 0.1 + 0.2;
  report.state_hash = 0xf000'0000'0000'0001 + number;
  CheckResult check{"upright",
                    "tilt of box",
                    "below 0.1 rad",
                    "rad",
                    passed,
                    0.25,
                    3.0,
                    passed ? "" : "tilt of box must be below 0.1 rad"};
  check.limits = {0.1};
  check.course = {{0.0, 0.0, 0.0}, {1.5, 0.01, 0.02}, {3.0, 0.2, 0.25}};
  report.checks.push_back(check);
  report.controllers.push_back(
      {"one", "exited with code 0", "", {"first \033[31mline", "]]> \xff {a: b} \t second"}});
  if (!passed) report.recording = "folder/run_2.mcap";
  return report;
}

Report there_and_back(const Report& report) {
  const cli::TempFolder folder;
  std::ofstream(folder.path() / "r.json") << report_as_json(report);
  return read_report(folder.path() / "r.json");
}

TEST(ReportFile, ComesBackAsItWas) {
  const Report report = run(2, false), back = there_and_back(report);
  EXPECT_EQ(back.name, report.name);
  EXPECT_EQ(back.swept, report.swept);
  EXPECT_EQ(back.run, 2u);
  EXPECT_EQ(back.code, cli::kFailed);
  EXPECT_EQ(back.seed, 7);
  EXPECT_EQ(back.recording, report.recording);
  EXPECT_EQ(back.state_hash, report.state_hash);
  EXPECT_EQ(back.wall_seconds, report.wall_seconds);
  ASSERT_EQ(back.checks.size(), 1u);
  EXPECT_EQ(back.checks[0].value, 0.25);
  EXPECT_EQ(back.checks[0].failure, report.checks[0].failure);
  EXPECT_EQ(back.checks[0].course, report.checks[0].course);
  EXPECT_EQ(back.checks[0].limits, report.checks[0].limits);
  ASSERT_EQ(back.controllers.size(), 1u);
  EXPECT_EQ(back.controllers[0].last_lines[0], "first \033[31mline");
}

TEST(ReportFile, AValueThatIsNoNumberStaysOne) {
  Report report = run(1, false);
  report.checks[0].value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(*there_and_back(report).checks[0].value));
  report.checks[0].value.reset();
  EXPECT_FALSE(there_and_back(report).checks[0].value.has_value());
}

TEST(ReportFile, CutShortAnywhereIsRefused) {
  const cli::TempFolder folder;
  const auto file = folder.path() / "r.json";
  const std::string whole = report_as_json(run(1, true));
  for (std::size_t size = 0; size + 2 < whole.size(); size += 7) {
    std::ofstream(file, std::ios::trunc) << whole.substr(0, size);
    EXPECT_THROW(read_report(file), config::ConfigError) << size;
  }
}

TEST(ReportHtml, ShowsWhatFailedFirstAndNothingFromOutside) {
  const std::vector<Report> reports{run(1, true), run(2, false), run(3, true)};
  const std::string page = report_html(reports);
  const auto table = page.find("<table>");
  EXPECT_LT(page.find("href=\"#run2\"", table), page.find("href=\"#run1\"", table));
  EXPECT_LT(page.find("id=\"run2\""), page.find("id=\"run1\""));
  EXPECT_LT(page.find("id=\"run1\""), page.find("id=\"run3\""));
  EXPECT_THAT(page, HasSubstr("1 of 3 runs failed; 3 different final states"));
  for (const char* outside : {"http:", "https:", "src=", "url(", "<link", "<script", "@import"})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
}

TEST(ReportHtml, EscapesWhatComesFromElsewhere) {
  const std::vector<Report> reports{run(2, false)};
  const std::string page = report_html(reports);
  EXPECT_THAT(page, HasSubstr("<h1>na&lt;me</h1>"));
  EXPECT_THAT(page, HasSubstr("&quot;x: &lt;y&gt;&quot;"));
  EXPECT_THAT(page, Not(HasSubstr("]]>")));
  EXPECT_THAT(page, HasSubstr("visum run 'a b.yaml' --only 2&#10;visum replay folder/run_2.mcap"));
}

TEST(ReportHtml, PlotsWhatFailedOnly) {
  EXPECT_THAT(report_html(std::vector<Report>{run(2, false)}), HasSubstr("<svg"));
  EXPECT_THAT(report_html(std::vector<Report>{run(2, true)}), Not(HasSubstr("<svg")));
}

TEST(Plot, IsWellFormedAndHoldsItsLimitAndItsWorst) {
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(plot(run(2, false).checks[0]).c_str()), tinyxml2::XML_SUCCESS);
  const auto* svg = document.FirstChildElement("svg");
  const double limit = svg->FirstChildElement("line")->DoubleAttribute("y1");
  const double worst = svg->FirstChildElement("circle")->DoubleAttribute("cy");
  EXPECT_LT(worst, limit) << "0.25 stands above 0.1";
  EXPECT_EQ(plot(CheckResult{}), "") << "never looked at";
}

TEST(ReportJunit, HasASuitePerRunAndCountsThemTogether) {
  const std::vector<Report> reports{run(1, true), run(2, false)};
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.Parse(report_junit(reports).c_str()), tinyxml2::XML_SUCCESS);
  const auto* all = document.FirstChildElement("testsuites");
  EXPECT_EQ(all->IntAttribute("tests"), 6);
  EXPECT_EQ(all->IntAttribute("failures"), 1);
  const auto* first = all->FirstChildElement("testsuite");
  EXPECT_STREQ(first->Attribute("name"), "na<me [run 1: mass=1, kind=\"x: <y>\"]");
  EXPECT_STREQ(first->NextSiblingElement("testsuite")->Attribute("failures"), "1");
}

TEST(RunLine, SaysWhyItFailed) {
  EXPECT_EQ(run_line(run(2, false), cli::Style(false)),
            "FAILED  run 2: mass=2, kind=\"x: <y>\"  0 of 1 checks, f000000000000003\n"
            "    FAILED  upright: tilt of box must be below 0.1 rad\n");
}

// A program that goes with its first run, which tells no result. As in `visum`, a write to a process that has
// ended is an error and no signal.
TEST(RunMany, AProcessThatCannotBeStartedCostsNoRunThatIsDone) {
  std::signal(SIGPIPE, SIG_IGN);
  const cli::TempFolder folder;
  ManyOptions options;
  options.program = folder.path() / "visum";
  std::ofstream(options.program) << "#!/bin/sh\nrm \"$0\"\nexit 4\n";
  std::filesystem::permissions(options.program, std::filesystem::perms::owner_all);
  options.runs = 3;
  const auto reports = run_many(options);
  ASSERT_EQ(reports.size(), 3u);
  EXPECT_EQ(reports[0].code, cli::kInvalid);  // it says nothing of the run
  EXPECT_THAT(reports[0].error, HasSubstr("exited with code 4"));
  for (const std::size_t run : {2u, 3u}) {
    EXPECT_EQ(reports[run - 1].run, run);
    EXPECT_EQ(reports[run - 1].code, cli::kFailed);
    EXPECT_THAT(reports[run - 1].error, HasSubstr("not started: cannot start"));
  }
  EXPECT_THAT(report_junit(reports), HasSubstr("errors=\"3\""));
}

TEST(RunMany, TheExitCodeIsTheOneThatSaysMost) {
  std::vector<Report> reports{run(1, true), run(2, true), run(3, true)};
  EXPECT_EQ(code_of(reports), cli::kDone);
  reports[1].code = cli::kInvalid;
  EXPECT_EQ(code_of(reports), cli::kInvalid) << "the host was too slow: neither passed nor failed";
  reports[2].code = cli::kFailed;
  EXPECT_EQ(code_of(reports), cli::kFailed);
  reports[0].code = cli::kLost;
  EXPECT_EQ(code_of(reports), cli::kLost);
  reports[1].code = cli::kBadConfig;
  EXPECT_EQ(code_of(reports), cli::kBadConfig);
}

}  // namespace
}  // namespace visum::run
