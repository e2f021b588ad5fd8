// The report of many runs as one HTML page, which refers to nothing outside of itself: a table of all runs,
// what failed first; then each run with its values, checks and figures, plots of what failed, and the command
// that does it again.
#pragma once

#include <span>
#include <string>

#include "clients/visum/run/report.h"

namespace visum::run {

// At least one report, all of one scenario's file.
std::string report_html(std::span<const Report> reports);

}  // namespace visum::run
