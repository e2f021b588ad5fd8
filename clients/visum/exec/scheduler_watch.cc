// Watches threads that have run for long: they may be dead, in a call that the shim does not know, computing
// or spinning.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "clients/visum/exec/scheduler.h"

namespace visum::exec {
namespace {

using shim::Slot;
using shim::State;
using std::chrono::seconds;

constexpr int kStill = 2;  // looks at which a thread sleeps before it counts as waiting
constexpr std::chrono::milliseconds kPassing{20};
// Processor time that a thread may use while others are ready. Not wall time: a busy host gives little.
constexpr long kPatience_s = 1;
constexpr seconds kStart{2};     // for a process to start
constexpr seconds kComplain{5};  // about a thread that runs
constexpr seconds kNotes{1};     // between notes for `visum status`

std::string text_of(const Slot& slot) {
  return "thread " + std::to_string(slot.tid) + " of " + process_name(slot.pid) + " (" +
         std::to_string(slot.pid) + ")";
}

}  // namespace

bool Scheduler::watch() {
  world_.look();
  bool impatient = false, any_slept = false;
  for (auto& slot : channel_.slots()) {
    if (slot.state != State::kRunning && slot.state != State::kStarting) continue;
    look_after(slot);
    impatient |= has_run_long(slot);
    any_slept |= watched_[number(slot)].still > 0;
  }
  // Better two threads at once than one that waits for ever for something that only the other can do.
  if (auto* ready = impatient ? next_ready() : nullptr) give_turn(*ready, false);
  return any_slept;
}

bool Scheduler::has_run_long(const Slot& slot) {
  static const auto ticks_per_s = static_cast<std::uint64_t>(::sysconf(_SC_CLK_TCK));
  const auto& watched = watched_[number(slot)];
  return slot.state == State::kRunning && watched.ticks - watched.began > kPatience_s * ticks_per_s;
}

void Scheduler::look_after(Slot& slot) {
  auto& watched = watched_[number(slot)];
  const auto state = threads_.state(slot.pid, slot.tid);
  if (slot.state == State::kStarting) return drop_if_late(slot);
  if (state.gone()) return free_if_gone(slot);
  const bool still = state.sleeps() && watched.turn == slot.go && watched.ticks == state.ticks;
  watched.still = still ? watched.still + 1 : 0;
  if (!still) watched.still_since = Clock::now();
  if (watched.turn != slot.go) watched.began = state.ticks;
  watched.turn = slot.go;
  watched.ticks = state.ticks;
  if (state.sleeps()) look_at_wait(slot, watched);
  complain(slot);
}

// The thread sleeps without having announced it. It may wait for input or for a child for long. Any other
// sleep may be over in a moment: a full pipe, a page that is read from disk.
void Scheduler::look_at_wait(const Slot& slot, Watched& watched) {
  const auto wait = Threads::wait_of(slot.pid, slot.tid);
  // It may have parked since it was looked at. Only the scheduler lets it run again.
  if (slot.state != State::kRunning || slot.go != watched.turn) return;
  if (wait == KernelWait::kHostTime)
    note_out_of_step(text_of(slot) +
                     " waits by the host's time: in a system call that the shim does not see");
  const bool in_earnest = wait == KernelWait::kInput || wait == KernelWait::kChild ||
                          Clock::now() - watched.still_since > kPassing;
  if (watched.still < kStill || !in_earnest) return;
  watched.unknown = true;
  watched.awaits_child = wait == KernelWait::kChild;
}

// A slot was reserved for a process that never took it: a static program, or one that ended at once.
void Scheduler::drop_if_late(Slot& slot) {
  auto& watched = watched_[number(slot)];
  if (watched.reserved != slot.ticket) {
    watched.reserved = slot.ticket;
    watched.starting_since = Clock::now();
  }
  if (Clock::now() - watched.starting_since < kStart) return;
  std::fprintf(
      stderr,
      "visum: a process that %s started does not keep in step: it is linked statically, or has ended\n",
      process_name(slot.parent != 0 ? slot.parent : slot.pid).c_str());
  note_out_of_step("a process that " + process_name(slot.parent) + " (" + std::to_string(slot.parent) +
                   ") started has not loaded the time shim");
  slot.pid = 0;
  slot.state = State::kFree;
}

void Scheduler::note_out_of_step(const std::string& why) {
  if (out_of_step_.empty()) out_of_step_ = why;
}

void Scheduler::check_announced(const Slot& slot) {
  const auto process = std::to_string(slot.pid);
  if (slot.state == State::kStarting && slot.parent != 0)
    note_out_of_step((slot.pid == 0 ? "a process" : "process " + process) + ", which " +
                     process_name(slot.parent) + " (" + std::to_string(slot.parent) +
                     ") started, has not loaded the time shim");
  if ((slot.flags & shim::kReplacing) != 0)
    note_out_of_step("process " + process + " has become a program that has not loaded the time shim");
}

// The program has ended. A process that it started just before may still be on its way to announce itself.
void Scheduler::await_announcements() {
  const auto give_up = Clock::now() + kStart;
  const auto is_on_its_way = [](const Slot& slot) {
    const auto state = slot.state.load();
    return (state == State::kStarting && slot.parent != 0) ||
           (state != State::kFree && (slot.flags & shim::kReplacing) != 0);
  };
  while (std::ranges::any_of(channel_.slots(), is_on_its_way) && Clock::now() < give_up) {
    for (auto& slot : channel_.slots())
      if (is_on_its_way(slot)) free_if_gone(slot);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  for (auto& slot : channel_.slots())
    if (is_on_its_way(slot)) check_announced(slot);
  if (const auto parent = memory_.stranger_of.load(); parent != 0)
    note_out_of_step("a command that process " + std::to_string(parent) +
                     " ran by system() has not loaded the time shim");
  if (const auto owner = memory_.host_timer_of.load(); owner != 0)
    note_out_of_step("process " + std::to_string(owner) +
                     " has a timer of timer_create(), which goes by the host's time");
  if (memory_.elsewhere != 0)
    note_out_of_step(
        "a process runs in a process namespace of its own, where the time shim cannot follow it");
  if (memory_.program_announced == 0) note_out_of_step("the program itself has not loaded the time shim");
}

// A program that loads the shim has a slot before its own code runs.
void Scheduler::end_program_without_shim() {
  if (memory_.used != 0 || !out_of_step_.empty() || Clock::now() - started_ < kComplain) return;
  note_out_of_step(process_name(program_) + " (" + std::to_string(program_) +
                   ") does not load the time shim, and the world waits for it: is it linked statically, or "
                   "setuid? --gate needs no shim");
  ::kill(program_, SIGKILL);
}

void Scheduler::complain(Slot& slot) {
  const auto now = Clock::now();
  const auto busy_for = std::chrono::duration_cast<seconds>(now - quiet_since_);
  auto& watched = watched_[number(slot)];
  if (watched.unknown || busy_for < kNotes) return;
  if (now - noted_ > kNotes) world_.note("waits for " + text_of(slot) + ", which runs");
  noted_ = now - noted_ > kNotes ? now : noted_;
  if (busy_for < kComplain || watched.told) return;
  watched.told = true;
  std::fprintf(
      stderr,
      "visum: %s has run for %lld s without waiting: it computes or spins, and the world waits for it\n",
      text_of(slot).c_str(), static_cast<long long>(busy_for.count()));
}

}  // namespace visum::exec
