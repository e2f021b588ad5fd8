#include "clients/visum/common/interrupt.h"

#include <atomic>
#include <csignal>

namespace visum::cli {
namespace {

// A signal comes on any thread.
std::atomic<bool> flag = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void on_signal(int) {
  flag = true;
}

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_signal;  // no SA_RESTART: a poll() in progress ends
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return flag;
}

}  // namespace visum::cli
