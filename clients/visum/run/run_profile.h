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
  // Processor time of visumd from its start to its end, with that of the processes that it waited for.
  void daemon_ended(double processor_s) { daemon_s_ = processor_s; }

  // Call it once when the run is over and all its processes have ended: writes the trace, and returns the
  // table. Throws std::runtime_error if the trace cannot be written.
  std::string finish();

 private:
  std::string table(const std::string& first_line, std::int64_t ended_ns) const;
  void write_trace();

  const std::filesystem::path trace_;
  cli::TempFolder folder_;
  config::Profile runner_;
  double daemon_s_ = 0.0;
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

}  // namespace visum::run
