// Notices a call into a plug-in that does not return. It warns after a second, and after a limit it ends the
// process, because a thread inside a foreign library cannot be taken back. Time is counted in looks and not
// read from a clock: a process that is stopped, or held by a debugger, does not count as stuck.
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

// The logic of the watch, without its thread, so that a test can tick it. Not thread-safe: one thread uses
// it.
class CallWatch {
 public:
  // kTold: the call has become stuck. kBack: it has returned after all. kLost: the limit is over. Each is
  // returned once; all other looks return kFine.
  enum class Verdict { kFine, kTold, kBack, kLost };

  // `limit` 0: a call may take for ever.
  explicit CallWatch(std::chrono::milliseconds limit) : limit_(limit) {}
  // `passed` is the time since the look before.
  Verdict look(std::chrono::milliseconds passed);
  const StuckNode& stuck() const { return stuck_; }

  static constexpr std::chrono::milliseconds kTell{1000};  // a call is stuck from here on

 private:
  const std::chrono::milliseconds limit_;
  std::chrono::milliseconds standing_{0};
  std::uint64_t calls_ = 0;
  StuckNode stuck_;
};

// Looks every 100 ms, on a thread of its own, from construction to destruction. The main of a program owns
// it; one per process, as plugin::foreign_node() is global.
class NodeWatch {
 public:
  // Calls `on_lost` on the watch's thread when a node is lost. By default that logs an error and ends the
  // process with exit code kTimedOut.
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
  CallWatch watch_;  // only the thread uses it
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  StuckNode stuck_;
  bool ended_ = false;
  std::thread thread_;  // last, because it uses the members above
};

}  // namespace visum::programs
