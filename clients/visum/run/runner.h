// Runs a scenario from start to end: daemon, controllers, steps, checks. Main thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "clients/visum/run/report.h"
#include "clients/visum/run/scenario.h"

namespace visum::run {

class ForkServer;
class RunProfile;

struct RunOptions {
  std::filesystem::path visumd;            // the daemon's program
  std::uint16_t port = 0;                  // 0: any free one
  std::vector<std::string> plugins{};      // folders that the scene's plug-ins may come from
  std::optional<double> node_timeout_s{};  // how long one of their calls may take; none: visumd's default
  bool caches = true;                      // visumd keeps converted meshes, and uses kept ones
  int threads = 1;                         // of the engine
  RunProfile* profile = nullptr;           // measures the run; must outlive it
  bool notes_files = false;                // fills Report::files
  ForkServer* forks = nullptr;             // starts the daemon; null: it is started in the ordinary way
  bool keep = false;                       // afterwards let the world run in real time until interrupted
  // Called with each line of the daemon and the controllers, and with what the time line says.
  std::function<void(const std::string& who, const std::string& line)> on_line;
  // Called once with each check, as soon as its result is certain.
  std::function<void(const CheckResult& check)> on_check;
  // Called after each step.
  std::function<void(double sim_s)> on_step;
  // Called once when the scenario is over and `keep` begins, before the world goes on.
  std::function<void(const Report& report, std::uint16_t port, const Catalogue& catalogue)> on_keep;
};

// Never throws for a failure of the run: Report::code and Report::error hold it. All processes that it
// started have ended when it returns.
Report run_scenario(const Scenario& scenario, const RunOptions& options);

}  // namespace visum::run
