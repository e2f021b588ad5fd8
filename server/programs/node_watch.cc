#include "server/programs/node_watch.h"

#include <spdlog/spdlog.h>

#include "protocol/plugin/foreign_call.h"
#include "server/programs/program.h"

namespace visum::programs {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLook{100};

double seconds(milliseconds time) {
  return static_cast<double>(time.count()) * 1e-3;
}

}  // namespace

CallWatch::Verdict CallWatch::look(milliseconds passed) {
  const std::uint64_t calls = plugin::foreign_calls();
  const char* node = plugin::foreign_node();
  if (calls != calls_ || !node) {
    calls_ = calls;
    standing_ = milliseconds(0);
    const bool was_stuck = !stuck_.node.empty();
    stuck_ = {};
    return was_stuck ? Verdict::kBack : Verdict::kFine;
  }
  const bool was_lost = limit_.count() > 0 && standing_ >= limit_;
  standing_ += passed;
  if (standing_ < kTell && (limit_.count() == 0 || standing_ < limit_)) return Verdict::kFine;
  const bool is_new = stuck_.node.empty();
  stuck_ = {node, standing_};
  if (limit_.count() > 0 && standing_ >= limit_) return was_lost ? Verdict::kFine : Verdict::kLost;
  return is_new ? Verdict::kTold : Verdict::kFine;
}

NodeWatch::NodeWatch(milliseconds limit, std::function<void(const StuckNode&)> on_lost)
    : on_lost_(std::move(on_lost)), watch_(limit), thread_([this] { run(); }) {}

NodeWatch::~NodeWatch() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

StuckNode NodeWatch::stuck() const {
  const std::lock_guard lock(mutex_);
  return stuck_;
}

void NodeWatch::run() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, kLook, [this] { return ended_; })) {
    const auto last = stuck_;
    const auto verdict = watch_.look(kLook);
    stuck_ = watch_.stuck();
    if (verdict == CallWatch::Verdict::kTold)
      spdlog::warn("{} has not come back for {:.1f} s: everything waits for it", stuck_.node,
                   seconds(stuck_.since));
    if (verdict == CallWatch::Verdict::kBack)
      spdlog::warn("{} has come back, after {:.1f} s", last.node, seconds(last.since));
    if (verdict == CallWatch::Verdict::kLost) on_lost_(stuck_);
  }
}

// Ends without destructors, which could wait for a lock that the lost thread holds.
void NodeWatch::end_process(const StuckNode& lost) {
  spdlog::error(
      "{} has not come back for {:.1f} s and is given up: its plug-in hangs. What it holds cannot be\n"
      "taken back, so this ends here (--node-timeout sets the limit)",
      lost.node, seconds(lost.since));
  end_at_once(kTimedOut);
}

}  // namespace visum::programs
