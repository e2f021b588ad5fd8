// A sink of the log that keeps its newest lines for the sessions' thread, which tells them to clients. Lines
// may come from any thread; nobody waits.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::gateway {

class LogTap {
 public:
  static constexpr std::size_t kMostLines = 256;  // that wait; more are dropped and counted

  // Make it before other threads log, and destroy it after they have ended: the log's list of sinks has no
  // lock.
  LogTap();
  ~LogTap();
  LogTap(const LogTap&) = delete;
  LogTap& operator=(const LogTap&) = delete;

  struct Line {
    protocol::EventLevel level;
    std::string text;
  };
  // Moves the lines that wait into `lines`. Returns how many were dropped since the last call.
  std::uint64_t take(std::vector<Line>& lines);

 private:
  struct Sink;
  std::shared_ptr<Sink> sink_;  // spdlog wants shared sinks
};

}  // namespace visum::gateway
