// A sink of the log that puts every line into a recording too, for as long as it lives.
#pragma once

#include <memory>

#include "server/recording/recorder.h"

namespace visum::recording {

class LogSink {
 public:
  // Before other threads log, and gone after they have ended.
  explicit LogSink(Recorder& recorder);
  ~LogSink();

 private:
  struct Sink;
  std::shared_ptr<Sink> sink_;  // the log keeps it so
};

}  // namespace visum::recording
