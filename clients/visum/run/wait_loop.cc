#include "clients/visum/run/wait_loop.h"

#include <algorithm>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/interrupt.h"

namespace visum::run {

using std::chrono::milliseconds;

void WaitLoop::check_limits() const {
  if (cli::interrupted()) throw cli::ExitError(cli::kInterrupted, "interrupted");
  if (Clock::now() >= give_up_)
    throw cli::ExitError(cli::kTimedOut, "not done after " + cli::exact(wall_s_) + " s of wall time");
}

void WaitLoop::wait_for_ends(milliseconds patience) {
  check_limits();
  set_.clear();
  for (const processes::ChildProcess* child : children_) {
    child->add_to(set_);
    if (child->exit_fd() >= 0) set_.push_back({child->exit_fd(), POLLIN, 0});
  }
  ::poll(set_.data(), set_.size(), static_cast<int>(patience.count()));
  for (processes::ChildProcess* child : children_) child->drain();
}

bool WaitLoop::wait(int fd, milliseconds patience) {
  const auto end = Clock::now() + patience;
  for (;;) {
    check_limits();
    const auto now = Clock::now();
    set_.clear();
    if (fd >= 0) set_.push_back({fd, POLLIN, 0});
    for (const processes::ChildProcess* child : children_) child->add_to(set_);
    const auto left = std::chrono::ceil<milliseconds>(std::min(end, give_up_) - now);  // `end` is never far
    ::poll(set_.data(), set_.size(),
           static_cast<int>(std::clamp(left, milliseconds(0), milliseconds(1000)).count()));
    const bool readable = fd >= 0 && set_.front().revents != 0;
    const bool output = std::any_of(set_.begin() + (fd >= 0 ? 1 : 0), set_.end(),
                                    [](const pollfd& one) { return one.revents != 0; });
    if (output) {
      for (processes::ChildProcess* child : children_) child->drain();
    }
    if (readable) return true;
    if (output && fd < 0) return false;
    if (Clock::now() >= end) return false;
  }
}

void WaitLoop::wait(int fd) {
  while (!wait(fd, milliseconds(1000))) {
  }
}

}  // namespace visum::run
