// A sink of the log that puts every line into a recording, too, once there is one.
#pragma once

#include <memory>

#include "server/recording/recorder.h"

namespace visum::recording {

class LogSink {
 public:
  // Before other threads log, and gone after they have ended.
  LogSink();
  ~LogSink();
  // Any thread. From now on into this one; null: into none any more.
  void follow(Recorder* recorder);

 private:
  struct Sink;
  std::shared_ptr<Sink> sink_;  // the log keeps it so
};

}  // namespace visum::recording
