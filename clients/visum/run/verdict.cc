#include "clients/visum/run/verdict.h"

#include <algorithm>

namespace visum::run {

void fail(Report& report, cli::ExitCode code, const std::string& error) {
  report.code = code;
  report.error = error;
}

void judge(Report& report) {
  if (report.code != cli::kDone) return;
  // A controller may have ended badly in the very last step, or been late while others went on.
  for (const auto& controller : report.controllers) {
    if (controller.failure.empty()) continue;
    return fail(report, controller.lost ? cli::kLost : cli::kFailed,
                "controller '" + controller.name + "' " + controller.failure);
  }
  const bool good = report.failures.empty() && std::all_of(report.checks.begin(), report.checks.end(),
                                                           [](const auto& c) { return c.passed; });
  report.code = good ? cli::kDone : cli::kFailed;
}

void invalidate(Report& report, const std::string& why) {
  if (report.code != cli::kDone && report.code != cli::kFailed) return;
  fail(report, cli::kInvalid, report.error.empty() ? why : why + "; " + report.error);
}

}  // namespace visum::run
