// A sink of the log that copies every line into the recording, while there is one. Lines may come from any
// thread; the sink's lock orders them.
#pragma once

#include <memory>

#include "server/recording/recorder.h"

namespace visum::recording {

class LogSink {
 public:
  // Make it before other threads log, and destroy it after they have ended: the log's list of sinks has no
  // lock.
  LogSink();
  ~LogSink();
  // From now on copies to this recorder; null: to none. Any thread.
  void follow(Recorder* recorder);

 private:
  struct Sink;
  std::shared_ptr<Sink> sink_;  // spdlog wants shared sinks
};

}  // namespace visum::recording
