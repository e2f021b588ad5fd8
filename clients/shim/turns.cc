#include "clients/shim/turns.h"

#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "clients/shim/futex.h"
#include "clients/shim/namespaces.h"
#include "clients/shim/real.h"

namespace visum::shim {
namespace {

// Looks in a row without a wait that no thread is taken to spin by. A program that only starts looks often,
// too: Python reads a clock 1161 times to import its client. A thread that was found to spin is found sooner
// the next time.
constexpr int kMostLooks = 20'000, kMostLooksOfSpinner = 200;
constexpr int kFewLooks = 100;  // it hardly matters whether these count
// A thread that spins passes this share of the time for which it has spun already, at least a tick: so it
// waits 1 s by some 170 steps and not by 1000, and comes 3 % late at most. A loop that looks for ever, a
// monitor for example, is never more than 10 ms late.
constexpr std::int64_t kSpinShare = 32, kLongestSpinStep_ns = 10'000'000;
constexpr int kMostRequests = 1000;                   // while no time passes
constexpr std::int64_t kPatience_ns = 1'000'000'000;  // then we look whether the scheduler lives

Shared* the_shared = nullptr;
__thread Slot* my_slot = nullptr;
__thread int looks = 0;
__thread bool said_that_we_spin = false;
__thread std::int64_t spins_since_ns = 0;
__thread int requests = 0;  // at requested_ns
__thread std::int64_t requested_ns = 0;
__thread bool said_that_we_ask = false;

std::int32_t thread_id() {
  return static_cast<std::int32_t>(VISUM_REAL(syscall)(SYS_gettid));
}

bool any_runs() {
  const auto used = the_shared->used.load();
  for (std::uint32_t i = 0; i < used; ++i) {
    const auto state = the_shared->slots[i].state.load();
    if (state == State::kRunning || state == State::kStarting) return true;
  }
  return false;
}

// The last thread that stops running wakes the scheduler.
void ring() {
  if (any_runs()) return;
  the_shared->bell.fetch_add(1);
  futex_wake(the_shared->bell);
}

void check_scheduler() {
  if (::kill(the_shared->scheduler, 0) == 0 || errno != ESRCH) return;
  say("the process that drives the time is gone");
  ::_exit(125);
}

// Waits until the scheduler gives us our turn, that is until `go` is no longer `before`. False where a signal
// was handled meanwhile.
bool await_turn(Slot& slot, std::uint32_t before) {
  bool undisturbed = true;
  while (slot.go.load() == before) {
    const int error = futex_wait(slot.go, before, kPatience_ns);
    if (error == ETIMEDOUT) check_scheduler();
    if (error != EINTR) continue;
    undisturbed = false;
    auto parked = State::kParked;
    if (slot.state.compare_exchange_strong(parked, State::kReady)) ring();
  }
  return undisturbed;
}

void send_alarm(Slot& slot) {
  if (slot.flags.fetch_and(~kAlarm) & kAlarm) ::kill(::getpid(), SIGALRM);
}

Slot* claim_slot(State from, State to, std::int32_t pid, std::int32_t parent) {
  for (auto& slot : the_shared->slots) {
    const auto state = slot.state.load();
    if (state != from) continue;
    const auto kept_for = slot.pid.load();
    const bool meant =
        from == State::kFree || ((kept_for == 0 || kept_for == pid) && slot.parent.load() == parent);
    auto expected = from;
    if (meant && slot.state.compare_exchange_strong(expected, to)) return &slot;
  }
  return nullptr;
}

void widen(const Slot& slot) {
  const auto needed = static_cast<std::uint32_t>(&slot - the_shared->slots) + 1;
  auto used = the_shared->used.load();
  while (used < needed && !the_shared->used.compare_exchange_weak(used, needed)) {
  }
}

void fill(Slot& slot, std::int32_t pid, std::int32_t tid, std::int32_t parent) {
  slot.flags = 0;
  slot.key = 0;
  slot.deadline_ns = kNever;
  slot.ticket = the_shared->tickets.fetch_add(1);
  slot.tid = tid;
  slot.parent = parent;
  slot.pid = pid;
  widen(slot);
}

void free_slot(Slot& slot) {
  slot.pid = 0;
  slot.state = State::kFree;
}

// exec() keeps the process: take over its slot, and free those of its former threads.
Slot* slot_from_before(std::int32_t pid) {
  Slot* found = nullptr;
  for (auto& slot : the_shared->slots) {
    if (slot.state.load() == State::kFree || slot.pid.load() != pid) continue;
    if (!found && (slot.tid.load() == pid || slot.state.load() == State::kStarting))
      found = &slot;
    else
      free_slot(slot);
  }
  return found;
}

// Leaves a process out that has another number here than the scheduler sees. It goes by the host's time from
// now on, and the run is invalid.
bool is_elsewhere() {
  if (pid_namespace() == the_shared->pid_namespace) return false;
  the_shared->elsewhere = 1;
  the_shared = nullptr;
  return true;
}

void attach() {
  if (is_elsewhere()) return;
  const auto pid = static_cast<std::int32_t>(::getpid());
  auto* slot = slot_from_before(pid);
  if (!slot) slot = claim_slot(State::kStarting, State::kRunning, pid, ::getppid());
  if (!slot) slot = claim_slot(State::kFree, State::kRunning, pid, 0);
  if (!slot) {
    say("more than %u threads", kMostThreads);
    ::_exit(125);
  }
  fill(*slot, pid, thread_id(), 0);
  slot->state = State::kRunning;
  my_slot = slot;
  if (::getppid() == the_shared->scheduler) the_shared->program_announced = 1;
}

__attribute__((constructor(101))) void open_channel() {
  const char* path = ::getenv(kVariable);
  if (!path) return;
  const int fd = ::open(path, O_RDWR | O_CLOEXEC);
  void* memory =
      fd < 0 ? MAP_FAILED : ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (fd >= 0) ::close(fd);
  if (memory == MAP_FAILED || static_cast<Shared*>(memory)->magic != kMagic) {
    say("cannot use %s=%s: %s", kVariable, path,
        memory == MAP_FAILED ? ::strerror(errno) : "of another version");
    ::_exit(125);
  }
  the_shared = static_cast<Shared*>(memory);
  attach();
}

__attribute__((destructor)) void end_of_process() {
  if (active()) leave_process();
}

}  // namespace

// Tells the program's libraries that its clocks are ours (protocol/busy_wait.h).
VISUM_EXPORT int visum_time_shim() {
  return the_shared != nullptr;
}

Shared* shared() {
  return the_shared;
}

Slot& mine() {
  if (my_slot) return *my_slot;
  my_slot =
      claim_slot(State::kFree, State::kRunning, 0, 0);  // a thread that was not started by pthread_create()
  if (!my_slot) {
    say("more than %u threads", kMostThreads);
    ::_exit(125);
  }
  fill(*my_slot, ::getpid(), thread_id(), 0);
  return *my_slot;
}

std::int64_t now_ns() {
  return the_shared->now_ns.load();
}

void announce(const Wait& wait) {
  auto& slot = mine();
  ::strncpy(slot.doing, wait.doing, kNameSize - 1);
  slot.deadline_ns = wait.deadline_ns;
  slot.checked = the_shared->activity.load();
  slot.ticket = the_shared->tickets.fetch_add(1);
  slot.flags = wait.flags;
  slot.key = wait.key;
}

bool park_announced() {
  looks = 0;
  auto& slot = mine();
  const auto before = slot.go.load();
  slot.state = State::kParked;
  ring();
  const bool undisturbed = await_turn(slot, before);
  slot.key = 0;
  const bool alarmed = (slot.flags.load() & kAlarm) != 0;
  send_alarm(slot);
  return undisturbed && !alarmed;
}

bool park(const Wait& wait) {
  announce(wait);
  return park_announced();
}

void enter_blocked(const char* doing, std::uint32_t flags, std::uint64_t key) {
  looks = 0;
  auto& slot = mine();
  ::strncpy(slot.doing, doing, kNameSize - 1);
  slot.ticket = the_shared->tickets.fetch_add(1);
  slot.flags = flags;
  slot.key = key;
  slot.state = State::kBlocked;
  ring();
}

void leave_blocked() {
  begin_turn();
  mine().key = 0;
}

void begin_turn() {
  auto& slot = mine();
  const auto before = slot.go.load();
  slot.state = State::kReady;
  ring();
  await_turn(slot, before);
}

void note_look(const char* doing, bool on_bus) {
  const int most = said_that_we_spin ? kMostLooksOfSpinner : kMostLooks;
  if (++looks <= most) return;
  if (looks == most + 1 || spins_since_ns > now_ns()) spins_since_ns = now_ns();
  if (!said_that_we_spin)
    say("thread %d of process %d spins on %s: from now on each such call takes a tick or more", thread_id(),
        ::getpid(), doing);
  said_that_we_spin = true;
  const int error = errno;
  const auto share = std::min((now_ns() - spins_since_ns) / kSpinShare, kLongestSpinStep_ns);
  const auto step = std::max(shared()->tick_ns, share);
  const int so_far = std::max(looks, kMostLooksOfSpinner + 1);
  // One that looks at a bus looks again as soon as the bus sends something. It has looked in vain (kAgain):
  // two that spin must not wake each other for ever.
  park({doing, now_ns() + step, on_bus ? kRecheck | kAgain : 0U});
  errno = error;
  looks = so_far;
}

// Starts counting again where time has passed by the thread's own waits.
void note_request() {
  if (now_ns() != requested_ns) requests = 0;
  requested_ns = now_ns();
  if (++requests <= kMostRequests) return;
  if (!std::exchange(said_that_we_ask, true))
    say("thread %d of process %d asks without letting time pass: from now on each request takes a tick",
        thread_id(), ::getpid());
  const int error = errno;
  park({"request", now_ns() + shared()->tick_ns});
  errno = error;
  requests = kMostRequests;
  requested_ns = now_ns();
}

void note_progress() {
  looks = 0;
}

bool has_looked_little() {
  return !said_that_we_spin && looks < kFewLooks;
}

Slot* keep_slot(std::int32_t pid, std::int32_t parent) {
  auto* slot = claim_slot(State::kFree, State::kStarting, 0, 0);
  if (slot) fill(*slot, pid, 0, parent);
  return slot;
}

void take_slot(Slot& slot) {
  if (is_elsewhere()) return drop_slot(slot);
  my_slot = &slot;
  looks = 0;
  slot.tid = thread_id();
  slot.pid = ::getpid();
  begin_turn();
}

void drop_slot(Slot& slot) {
  auto starting = State::kStarting;
  slot.state.compare_exchange_strong(starting, State::kFree);  // else it has been taken
}

void give_up_slot(Slot& slot) {
  auto starting = State::kStarting;
  if (slot.state.compare_exchange_strong(starting, State::kFree))
    the_shared->stranger_of = static_cast<std::int32_t>(::getpid());
}

void leave() {
  mine().state = State::kLeaving;
  ring();
}

void leave_process() {
  const auto pid = static_cast<std::int32_t>(::getpid());
  for (auto& slot : the_shared->slots)
    if (slot.pid.load() == pid && slot.state.load() != State::kFree) slot.state = State::kLeaving;
  ring();
}

void say(const char* format, ...) {
  char text[256] = "visum: ";
  va_list list;
  va_start(list, format);
  const auto head = ::strlen(text);
  ::vsnprintf(text + head, sizeof text - head - 1, format, list);
  va_end(list);
  ::strcat(text, "\n");
  VISUM_REAL(syscall)(SYS_write, 2, text, ::strlen(text));
}

}  // namespace visum::shim
