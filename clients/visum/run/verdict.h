// The verdict and the exit code that follow from a run's findings. Pure functions.
#pragma once

#include <string>

#include "clients/visum/run/report.h"

namespace visum::run {

void fail(Report& report, cli::ExitCode code, const std::string& error);
// Judges a run that went to its end: passed, failed, or a controller was lost.
void judge(Report& report);
// Neither success nor failure means anything on a host that was too slow, or where a program was not in step
// or exchanged nothing.
void invalidate(Report& report, const std::string& why);

}  // namespace visum::run
