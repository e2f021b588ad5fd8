// The recorder of a daemon's world, with its messages in the log. Main thread.
#pragma once

#include <optional>
#include <string>

#include "server/cycle/simulation.h"
#include "server/recording/log_sink.h"
#include "server/recording/recorder.h"

namespace visum::programs {

// Records all that happens in the world. Make the daemon first: a program that cannot have its port must not
// empty an older recording.
class Logbook {
 public:
  // `needed`: the recording's file. Where that is empty, `tried` is: one that cannot be written is a warning
  // only. Throws where a needed file cannot be made.
  Logbook(cycle::Simulation& simulation, const recording::Origin& origin, const std::string& needed,
          const std::string& tried, recording::LogSink& log);
  ~Logbook();
  Logbook(const Logbook&) = delete;
  Logbook& operator=(const Logbook&) = delete;

  // Completes the file. Returns false where it lacks something that was needed.
  bool close();

 private:
  std::optional<recording::Recorder> recorder_;
  recording::LogSink& log_;
  const bool needed_;
};

}  // namespace visum::programs
