// Notices a plug-in's call that does not come back: tells of it after a second, and calls it lost after a
// limit. A thread that is lost in a library cannot be taken back, so the process then ends. Time is counted
// in looks, not read from a clock: a process that is stopped, or held by a debugger, is not stuck.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "server/gateway/stuck_node.h"

namespace visum::programs {

using gateway::StuckNode;

// The watch without its thread. Any one thread.
class CallWatch {
 public:
  enum class Verdict { kFine, kTold, kBack, kLost };  // kTold, kBack, kLost: once each

  // `limit` 0: nothing is ever lost.
  explicit CallWatch(std::chrono::milliseconds limit) : limit_(limit) {}
  // `passed` after the look before.
  Verdict look(std::chrono::milliseconds passed);
  const StuckNode& stuck() const { return stuck_; }

  static constexpr std::chrono::milliseconds kTell{1000};

 private:
  const std::chrono::milliseconds limit_;
  std::chrono::milliseconds standing_{0};
  std::uint64_t calls_ = 0;
  StuckNode stuck_;
};

// On a thread of its own, for as long as it lives.
class NodeWatch {
 public:
  // `on_lost`: on the watch's thread, for the node that is lost. The usual one says so in the log and ends
  // the process with kTimedOut.
  explicit NodeWatch(std::chrono::milliseconds limit,
                     std::function<void(const StuckNode&)> on_lost = end_process);
  ~NodeWatch();
  NodeWatch(const NodeWatch&) = delete;
  NodeWatch& operator=(const NodeWatch&) = delete;

  StuckNode stuck() const;  // any thread

 private:
  [[noreturn]] static void end_process(const StuckNode& lost);
  void run();

  const std::function<void(const StuckNode&)> on_lost_;
  CallWatch watch_;  // the thread's
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  StuckNode stuck_;
  bool ended_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace visum::programs
