#include "protocol/busy_wait.h"

#include <dlfcn.h>

namespace visum::protocol {
namespace {

// How much less looking seems to help after a wait. A single interruption says little, as every machine has
// some; where threads want the processor, hardly a look comes without.
constexpr int kMissedDoubt = 1, kPushedDoubt = 2;
// A run begins while its programs start, which says nothing of the time after it. So no doubt lasts longer
// than 2^4 waits. Looking costs little even where others want the processor: they get it at the first look.
constexpr int kMostDoubt = 4;

bool has_processors() {
  cpu_set_t allowed;
  return ::sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) > 1;
}

bool is_under_time_shim() {
  void* const shim = ::dlsym(RTLD_DEFAULT, "visum_time_shim");  // clients/shim/turns.cc
  return shim != nullptr && reinterpret_cast<int (*)()>(shim)() != 0;
}

}  // namespace

BusyWait::BusyWait() : helps_(has_processors() && !is_under_time_shim()) {}

bool BusyWait::may_look() {
  if (!helps_) return false;
  if (skip_ == 0) return true;
  --skip_;
  return false;
}

bool BusyWait::found(bool pushed_out) {
  if (pushed_out)
    doubt(kPushedDoubt);
  else if (doubt_ > 0)
    --doubt_;
  return true;
}

bool BusyWait::missed(bool pushed_out) {
  doubt(pushed_out ? kPushedDoubt : kMissedDoubt);
  return false;
}

void BusyWait::doubt(int more) {
  doubt_ = std::min(doubt_ + more, kMostDoubt);
  skip_ = 1u << doubt_;
}

}  // namespace visum::protocol
