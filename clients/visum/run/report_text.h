// The report for people, and the lines of JSON for scripts.
#pragma once

#include <string>

#include "clients/visum/common/terminal.h"
#include "clients/visum/run/report.h"

namespace visum::run {

std::string report_text(const Report& report, const cli::Style& style);
// {"passed":true,"ticks":12000,"sim_seconds":12.0,"wall_seconds":0.4,"state_hash":"9f..."}, without a line's
// end.
std::string report_json(const Report& report);
// A line each: {"check":"...","passed":true,"value":0.0012,"unit":"m","bound":"below 0.01 m","at_s":12.0}.
std::string checks_json(const Report& report);

}  // namespace visum::run
