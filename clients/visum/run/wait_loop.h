// All waiting of the runner happens here. Meanwhile it passes on the children's output. It ends the wait when
// the user interrupts or the allowed wall time is over. One thread; children must outlive it or be forgotten.
#pragma once

#include <chrono>
#include <vector>

#include "protocol/processes/child_process.h"

namespace visum::run {

class WaitLoop {
 public:
  explicit WaitLoop(double wall_s) : wall_s_(wall_s), give_up_(Clock::now() + to_duration(wall_s)) {}

  void watch(processes::ChildProcess& child) { children_.push_back(&child); }
  void forget(processes::ChildProcess& child) { std::erase(children_, &child); }
  void lift_limit() { give_up_ = Clock::time_point::max(); }  // of the wall time

  // Waits until `fd` can be read (true) or `patience` is over (false). With fd -1 only children count. Throws
  // ExitError (interrupted, timed out).
  bool wait(int fd, std::chrono::milliseconds patience);
  // Waits until a child has ended or has said something. check_exit() must then be asked of all.
  void wait_for_ends(std::chrono::milliseconds patience);
  // Waits without a limit until `fd` can be read.
  void wait(int fd);

 private:
  using Clock = std::chrono::steady_clock;
  static Clock::duration to_duration(double s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
  }

  void check_limits() const;

  double wall_s_;
  Clock::time_point give_up_;
  std::vector<processes::ChildProcess*> children_;
  std::vector<pollfd> set_;  // scratch
};

}  // namespace visum::run
