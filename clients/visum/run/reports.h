// All forms in which reports are shown or written: text for people, lines of JSON for scripts, JUnit XML for
// CI, an HTML page, and the file by which the processes of a sweep hand on what they found. Pure functions,
// but for read_report.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "clients/visum/common/terminal.h"
#include "clients/visum/run/report.h"

namespace visum::run {

// ---------------------------------------------------------------------------------------- one run
// (report_text.cc)

// For people, in lines of at most 80 columns.
std::string report_text(const Report& report, const cli::Style& style);
// {"passed":true,"valid":true,"ticks":12000,"sim_seconds":12.0,"wall_seconds":0.4,"state_hash":"9f..."}
// Without a line's end.
std::string report_json(const Report& report);
// A line for each check:
// {"check":"...","passed":true,"value":0.0012,"unit":"m","bound":"below 0.01 m","at_s":12.0}
std::string checks_json(const Report& report);

// --------------------------------------------------------------------------------------- many runs
// (report_text.cc)

// "passed  run 3: payload=2, seed=1  4 of 4 checks, 9f3c0a5be2d81746"; for a run that failed also why.
std::string run_line(const Report& report, const cli::Style& style);
std::string many_text(std::span<const Report> reports, double wall_seconds, const cli::Style& style);

// {"run":3,"sweep":{"payload":"2"},"passed":true,"code":0,"ticks":...,"state_hash":"..."}
std::string run_json(const Report& report);
// {"passed":false,"runs":12,"failed":3,"wall_seconds":4.2}
std::string many_json(std::span<const Report> reports, double wall_seconds);

// ---------------------------------------------------------------------------------------- for CI
// (report_junit.cc)

// JUnit XML: a suite for each run. It has a test case for each check, one for each controller, and one for
// the run as a whole; figures such as the state hash are properties.
std::string report_junit(const Report& report);
std::string report_junit(std::span<const Report> reports);

// -------------------------------------------------------------------------------------- as a page
// (report_html.cc)

// One HTML page that refers to nothing outside of itself. First comes a table of all runs, failures first.
// Then comes each run with its values, checks and figures, plots of the checks that failed, and the command
// that repeats it. Needs at least one report; all must come from one scenario's file.
std::string report_html(std::span<const Report> reports);

// ---------------------------------------------------------------------------------------- as a file
// (report_file.cc)

// Everything that a report holds as JSON, which is YAML too. Numbers keep all bits; NaN and infinity become
// null.
std::string report_as_json(const Report& report);
// Reads such a file. Throws config::ConfigError if it is something else, or cut short.
Report read_report(const std::filesystem::path& file);

}  // namespace visum::run
