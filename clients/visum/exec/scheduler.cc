#include "clients/visum/exec/scheduler.h"

#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <set>
#include <thread>

#include "clients/shim/futex.h"
#include "clients/visum/common/exit_code.h"

namespace visum::exec {
namespace {

using shim::Slot;
using shim::State;

// A thread that runs is looked after at first soon, as it may wait in a call that the shim does not know, and
// then at intervals that double. A look interrupts a program that computes, so the first one comes later
// where it has only found threads that ran.
constexpr std::int64_t kFirstWatch_ns = 100'000, kLatestFirstWatch_ns = 2'000'000, kWatch_ns = 10'000'000;
constexpr std::int64_t kSoon_ns = 50'000;  // a thread is about to end or to wake up
constexpr std::int64_t kMostTicks = 1000;  // at once; then look for threads that woke up by themselves

constexpr std::chrono::seconds kLastAdvance{5};  // how long to wait for the world once the program has ended
constexpr std::chrono::milliseconds kWaking{500};  // how long to wait for a parent to notice its child's end

bool is_ready(const Slot& slot, std::int64_t now_ns) {
  const auto state = slot.state.load();
  if (state == State::kReady) return true;
  return state == State::kParked &&
         ((slot.flags & (shim::kGranted | shim::kAlarm)) != 0 || slot.deadline_ns <= now_ns);
}

}  // namespace

Scheduler::Scheduler(TimeChannel& channel, WorldLink& world, pid_t program, std::int64_t period_ticks,
                     Clock::time_point give_up)
    : channel_(channel),
      memory_(channel.memory()),
      world_(world),
      program_(program),
      period_ticks_(period_ticks),
      give_up_(give_up),
      first_watch_ns_(kFirstWatch_ns) {}

// The rules: one thread at a time; a thread that is due before one that may look again; then the buses; then
// time.
int Scheduler::run() {
  for (;;) {
    await_quiet();
    if (ended_) break;
    note_outcome();
    if (auto* ready = next_ready())
      give_turn(*ready, false);
    else if (auto* looker = next_to_recheck())
      give_turn(*looker, true);
    else if (!settle_for_one())
      advance();
  }
  advance_by(0);  // handles the last bytes that the program wrote
  await_announcements();
  return *ended_;
}

void Scheduler::await_quiet() {
  quiet_since_ = Clock::now();
  auto watch_ns = first_watch_ns_;
  for (check_end(); !ended_; check_end()) {
    quiet_bell_ = memory_.bell.load();
    bool soon = false;
    if (is_quiet(soon)) return;
    const auto rings = [&] { return memory_.bell.load() != quiet_bell_; };
    if (!soon && busy_wait_.find(rings, std::chrono::nanoseconds(watch_ns))) continue;
    if (shim::futex_wait(memory_.bell, quiet_bell_, soon ? kSoon_ns : watch_ns) != ETIMEDOUT || soon)
      continue;
    const bool any_slept = watch();
    first_watch_ns_ = any_slept ? kFirstWatch_ns : std::min(2 * first_watch_ns_, kLatestFirstWatch_ns);
    watch_ns = std::min(2 * watch_ns, kWatch_ns);
  }
}

void Scheduler::check_end() {
  int status = 0;
  if (!ended_ && ::waitpid(program_, &status, WNOHANG) == program_) {
    ended_ = status;
    ended_at_ = Clock::now();
  }
  if (!ended_ && Clock::now() > give_up_)
    throw cli::ExitError(cli::kTimedOut, "the program has not ended in time");
}

bool Scheduler::is_patient() {
  check_end();
  return !ended_ || Clock::now() < ended_at_ + kLastAdvance;
}

// Sets `soon` where no thread runs but one is about to end or to wake up. Two passes: first no thread may run
// at all, because only then can none be woken while the second pass asks for one after the other. A thread
// that ran at the start and waits by now has drawn a ticket: it may have woken one that was passed already.
bool Scheduler::is_quiet(bool& soon) {
  bool busy = false;
  const auto tickets = memory_.tickets.load();
  for (auto& slot : channel_.slots()) {
    if (slot.state == State::kLeaving) {
      free_if_gone(slot);
      soon = true;  // also where it has ended: its end wakes up the thread that waited for it
    }
    busy |= is_busy(slot);
  }
  for (auto& slot : channel_.slots()) soon |= !busy && !is_still(slot);
  soon = !busy && (soon || memory_.tickets != tickets);
  return !busy && !soon;
}

bool Scheduler::is_busy(Slot& slot) {
  const auto state = slot.state.load();
  auto& watched = watched_[number(slot)];
  if (state != State::kRunning) watched.unknown = false;
  return state == State::kStarting || (state == State::kRunning && !watched.unknown);
}

// True if a thread that says it waits really sleeps. A thread that was woken in the kernel, or sent a signal,
// shows at once as running. The thread that had the last turn may still be on its way to sleep, so its own
// word counts: nobody else has run who could have woken it.
bool Scheduler::is_still(Slot& slot) {
  const auto declared = slot.state.load();
  auto& watched = watched_[number(slot)];
  if (declared != State::kBlocked && declared != State::kParked && !watched.unknown) return true;
  if (declared == State::kParked && &slot == last_turn_ && !watched.unknown) return true;
  const auto state = threads_.state(slot.pid, slot.tid);
  if (state.gone()) return free_if_gone(slot), false;
  if (watched.unknown && state.ticks != watched.ticks) watched.unknown = false;
  return state.sleeps();
}

// The kernel shows that a process has ended before it wakes up the parent that waits for it.
bool Scheduler::is_to_wake_parent(const Slot& ended, const ThreadState& state) {
  if (state.letter != 'Z') return false;
  const auto pid = ended.pid.load();
  bool awaited = false;
  for (auto& slot : channel_.slots()) {
    if (slot.state == State::kFree || &slot == &ended) continue;
    // Only its first thread has ended: the parent is woken by the end of the last.
    if (slot.pid == pid && !threads_.state(pid, slot.tid).gone()) return false;
    if (slot.pid != state.parent) continue;
    const auto& watched = watched_[number(slot)];
    const bool waits = slot.state == State::kBlocked && (slot.flags & shim::kAwaitsChild) != 0;
    const bool is_it = slot.key == 0 || slot.key == static_cast<std::uint64_t>(pid);
    awaited |= (waits && is_it) || (watched.unknown && watched.awaits_child);
  }
  return awaited;
}

void Scheduler::free_if_gone(Slot& slot) {
  const auto pid = slot.pid.load(), tid = slot.tid.load();
  if (pid == 0) return;
  const auto state = threads_.state(pid, tid != 0 ? tid : pid);
  if (!state.gone()) return;
  auto& ended = watched_[number(slot)].ended;
  if (is_to_wake_parent(slot, state)) {
    if (!ended) ended = Clock::now();
    slot.state = State::kLeaving;
    if (Clock::now() - *ended < kWaking) return;
  }
  ended.reset();
  // A thread that calls exec() goes on as its process' first one: its own end says nothing yet.
  const bool goes_on = tid != pid && (slot.flags & shim::kReplacing) != 0 && !threads_.state(pid, pid).gone();
  if (!goes_on) check_announced(slot);
  threads_.forget(tid != 0 ? tid : pid);
  for (auto& alarm : memory_.alarms)
    if (alarm.pid == pid && tid == pid) alarm.pid = 0;
  slot.key = 0;
  slot.pid = 0;
  slot.state = State::kFree;
}

Slot* Scheduler::next_ready() {
  const auto now = memory_.now_ns.load();
  Slot* next = nullptr;
  const auto order = [now](const Slot& slot) {
    return std::pair(std::min(now, slot.deadline_ns.load()), slot.ticket.load());
  };
  for (auto& slot : channel_.slots())
    if (is_ready(slot, now) && (!next || order(slot) < order(*next))) next = &slot;
  return next;
}

// A thread that may look again: others have run, or a bus has sent something, since it looked.
Slot* Scheduler::next_to_recheck() {
  Slot* next = nullptr;
  for (auto& slot : channel_.slots()) {
    const bool may =
        slot.state == State::kParked && (slot.flags & shim::kRecheck) != 0 && slot.checked < memory_.activity;
    if (may && (!next || slot.ticket < next->ticket)) next = &slot;
  }
  return next;
}

void Scheduler::give_turn(Slot& slot, bool again) {
  if (!again) ++memory_.activity;
  rechecking_ = again ? &slot : nullptr;
  watched_[number(slot)] = {};
  last_turn_ = &slot;
  slot.state = State::kRunning;
  ++slot.go;
  shim::futex_wake(slot.go);
}

// A thread that looked again and found something may have changed what the others wait for.
void Scheduler::note_outcome() {
  auto* slot = std::exchange(rechecking_, nullptr);
  if (!slot) return;
  const bool in_vain = slot->state == State::kParked && (slot->flags & shim::kAgain) != 0;
  if (!in_vain) ++memory_.activity;
}

// Serves the buses for a thread that asks for everything that they have sent by now.
bool Scheduler::settle_for_one() {
  for (auto& slot : channel_.slots()) {
    if (slot.state != State::kParked || (slot.flags & shim::kSettle) == 0) continue;
    if (advance_by(0)) slot.flags |= shim::kGranted;
    return true;
  }
  return false;
}

std::int64_t Scheduler::earliest() const {
  auto earliest = shim::kNever;
  for (auto& slot : channel_.slots())
    if (slot.state == State::kParked) earliest = std::min(earliest, slot.deadline_ns.load());
  for (auto& alarm : memory_.alarms)
    if (alarm.pid != 0) earliest = std::min(earliest, alarm.deadline_ns.load());
  return earliest;
}

bool Scheduler::any_on_bus() {
  return std::ranges::any_of(channel_.slots(), [this](const Slot& slot) {
    const bool parked = slot.state == State::kParked && (slot.flags & shim::kOnBus) != 0;
    return parked || (watched_[number(slot)].unknown && memory_.tty_count > 0);
  });
}

// True if a thread waits for the server, which answers in real time.
bool Scheduler::awaits_answer() {
  return std::ranges::any_of(channel_.slots(), [](const Slot& slot) {
    return slot.state == State::kBlocked && (slot.flags & shim::kHold) != 0;
  });
}

// All threads wait: run the world straight to the earliest wake-up. Where none waits for time or for a bus,
// the world stands until a thread wakes up by itself.
void Scheduler::advance() {
  const auto until = earliest();
  if (awaits_answer() || (until == shim::kNever && !any_on_bus())) {
    if (memory_.dirty) advance_by(0);
    end_program_without_shim();
    shim::futex_wait(memory_.bell, quiet_bell_, kWatch_ns);
    return;
  }
  advance_by(until == shim::kNever ? kMostTicks : ticks_to(until));
  ring_alarms();
}

// The ticks to the first period that begins at `until_ns` or later, kMostTicks at most.
std::int64_t Scheduler::ticks_to(std::int64_t until_ns) const {
  const auto tick_ns = world_.tick_ns(), now_ns = memory_.now_ns.load();
  const auto ticks = (until_ns - now_ns + tick_ns - 1) / tick_ns;
  if (ticks > kMostTicks) return kMostTicks;
  const auto end = now_ns / tick_ns + ticks;
  return ticks + (period_ticks_ - end % period_ticks_) % period_ticks_;
}

bool Scheduler::advance_by(std::int64_t ticks) {
  std::vector<protocol::Stream> streams;
  std::vector<shim::Stream*> theirs;
  for (auto& stream : memory_.streams) {
    if (stream.port == 0 || stream.port > UINT16_MAX) continue;
    streams.push_back({stream.port, stream.written, stream.said});
    theirs.push_back(&stream);
  }
  memory_.dirty = 0;
  if (!world_.advance(ticks, streams)) return false;
  for (std::size_t i = 0; i < streams.size(); ++i) theirs[i]->said = streams[i].heard;
  memory_.now_ns = world_.now_ns();
  if (world_.spoke()) ++memory_.activity;
  return true;
}

// A main thread that waits for its turn sends itself the signal, so that everything keeps its order. Else the
// kernel chooses a thread.
void Scheduler::ring_alarms() {
  for (auto& alarm : memory_.alarms) {
    if (alarm.pid == 0 || alarm.deadline_ns > memory_.now_ns) continue;
    alarm.deadline_ns = alarm.interval_ns > 0 ? alarm.deadline_ns + alarm.interval_ns : shim::kNever;
    const auto slots = channel_.slots();
    const auto main = std::ranges::find_if(slots, [&](const Slot& slot) {
      return slot.state == State::kParked && slot.pid == alarm.pid && slot.tid == alarm.pid;
    });
    if (main != slots.end())
      main->flags |= shim::kAlarm;
    else
      ::kill(alarm.pid, SIGALRM);
  }
}

void Scheduler::kill_all() {
  std::set<pid_t> processes;
  for (auto& slot : channel_.slots())
    if (slot.state != State::kFree && slot.pid > 0) processes.insert(slot.pid);
  if (!ended_) processes.insert(program_);
  for (const auto process : processes)
    if (process != program_ || !ended_) ::kill(process, SIGKILL);
  if (!ended_) ::waitpid(program_, nullptr, 0);
  const auto give_up = Clock::now() + kLastAdvance;
  for (const auto process : processes)
    while (process != program_ && !threads_.state(process, process).gone() && Clock::now() < give_up)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace visum::exec
