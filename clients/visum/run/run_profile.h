// `visum run --profile`: measures the runner, has visumd measure itself, and shows where the wall time of the
// run went. Main thread; the verb owns it.
#pragma once

#include <filesystem>
#include <string>

#include "clients/visum/common/temp_folder.h"
#include "protocol/config/profile.h"

namespace visum::run {

class RunProfile {
 public:
  // `trace` is a file for Perfetto; empty: only the table is wanted.
  explicit RunProfile(std::filesystem::path trace);

  config::Profile& runner() { return runner_; }
  std::filesystem::path daemon_file() const { return folder_.path() / "visumd.json"; }
  bool wants_spans() const { return !trace_.empty(); }

  // Call it once when the run is over and all its processes have ended: writes the trace, and returns the
  // table. Throws std::runtime_error if the trace cannot be written.
  std::string finish();

 private:
  void write_trace();

  const std::filesystem::path trace_;
  cli::TempFolder folder_;
  config::Profile runner_;
};

// The phases of the runner itself, for its Profile.
struct RunnerPhases {
  explicit RunnerPhases(config::Profile* profile) {
    if (profile == nullptr) return;
    controllers = profile->add("controllers' start");
    world = profile->add("waits for the world");
    checks = profile->add("checks");
  }
  config::Profile::Phase controllers = 0, world = 0, checks = 0;
};

// The table of a run that took from `began_ns` to `ended_ns`, by the first line of the file that visumd
// wrote. Throws ConfigError if that line is not visumd's.
std::string profile_table(const std::string& first_line, std::int64_t began_ns, std::int64_t ended_ns);

}  // namespace visum::run
