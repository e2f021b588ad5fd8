// Starts and ends of threads and processes. A new one waits for its turn before its first instruction.
#include "clients/shim/processes.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "clients/shim/real.h"
#include "clients/shim/turns.h"

using namespace visum::shim;

namespace {

struct Start {
  void* (*routine)(void*);
  void* argument;
  Slot* slot;
};

pthread_key_t last_words;
pthread_once_t last_words_once = PTHREAD_ONCE_INIT;

// Runs after the program's own destructors of thread-specific data, as far as rounds are left.
void end_of_thread(void* rounds) {
  const auto left = reinterpret_cast<std::uintptr_t>(rounds);
  if (left > 1)
    ::pthread_setspecific(last_words, reinterpret_cast<void*>(left - 1));
  else
    leave();
}

void make_last_words() {
  ::pthread_key_create(&last_words, end_of_thread);
}

void* run_thread(void* given) {
  const Start start = *static_cast<Start*>(given);
  ::free(given);
  ::pthread_setspecific(last_words, reinterpret_cast<void*>(3));
  take_slot(*start.slot);
  return start.routine(start.argument);
}

pid_t fork_in_turn() {
  return fork_by([] { return VISUM_REAL(fork)(); });
}

// Wraps a call that starts a process by itself. The process takes the reserved slot when it starts.
template <typename Call>
int starting(Call call, const pid_t* child) {
  auto* slot = keep_slot(0, ::getpid());
  const int result = call();
  if (!slot) return result;
  if (result != 0)
    drop_slot(*slot);
  else if (slot->state == State::kStarting && child)
    slot->pid = *child;
  return result;
}

struct CloneStart {
  int (*function)(void*);
  void* argument;
  Slot* slot;
};

int run_clone(void* given) {
  const CloneStart start = *static_cast<CloneStart*>(given);
  begin_child(*start.slot);
  return start.function(start.argument);
}

// A wait for a child, named as for waitpid(). A `pid` that is not positive means any child.
template <typename Call>
auto await_child(const char* doing, pid_t pid, Call call) {
  return blocked(doing, call, kAwaitsChild, pid > 0 ? static_cast<std::uint64_t>(pid) : 0);
}

}  // namespace

VISUM_EXPORT int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*routine)(void*),
                                void* argument) noexcept {
  if (!active()) return VISUM_REAL(pthread_create)(thread, attributes, routine, argument);
  ::pthread_once(&last_words_once, make_last_words);
  auto* slot = keep_slot(::getpid(), 0);
  auto* start = static_cast<Start*>(::malloc(sizeof(Start)));
  if (!slot || !start) {
    if (slot) drop_slot(*slot);
    ::free(start);
    return EAGAIN;
  }
  *start = {routine, argument, slot};
  const int error = VISUM_REAL(pthread_create)(thread, attributes, run_thread, start);
  if (error == 0) return 0;
  drop_slot(*slot);
  ::free(start);
  return error;
}

VISUM_EXPORT int pthread_join(pthread_t thread, void** result) {
  if (!active()) return VISUM_REAL(pthread_join)(thread, result);
  return blocked("pthread_join", [&] { return VISUM_REAL(pthread_join)(thread, result); });
}

VISUM_EXPORT pid_t fork() noexcept {
  return active() ? fork_in_turn() : VISUM_REAL(fork)();
}

// The same as fork(): the child gets its own copy of the memory, and the parent does not wait.
VISUM_EXPORT pid_t vfork() noexcept {
  return active() ? fork_in_turn() : VISUM_REAL(fork)();
}

// Like fork(), unless the child shares our memory for longer than until its exec(): such a one is not
// followed.
VISUM_EXPORT int clone(int (*function)(void*), void* stack, int flags, void* argument, ...) noexcept {
  va_list list;
  va_start(list, argument);
  auto* parent_tid = va_arg(list, pid_t*);
  auto* tls = va_arg(list, void*);
  auto* child_tid = va_arg(list, pid_t*);
  va_end(list);
  const auto call = [&](int (*body)(void*), int with, void* given) {
    return VISUM_REAL(clone)(body, stack, with, given, parent_tid, tls, child_tid);
  };
  if (!active()) return call(function, flags, argument);
  if (!is_like_fork(flags)) return spawn_by([&] { return call(function, flags, argument); });
  auto* slot = keep_slot(0, ::getpid());
  if (!slot) {
    errno = EAGAIN;
    return -1;
  }
  CloneStart start{function, argument, slot};
  const int child = call(run_clone, static_cast<int>(as_fork(flags)), &start);
  if (child < 0) drop_slot(*slot);
  return child;
}

VISUM_EXPORT int posix_spawn(pid_t* child, const char* path, const posix_spawn_file_actions_t* actions,
                             const posix_spawnattr_t* attributes, char* const argv[], char* const envp[]) {
  pid_t pid = 0;
  const auto call = [&] { return VISUM_REAL(posix_spawn)(&pid, path, actions, attributes, argv, envp); };
  const int error = active() ? starting(call, &pid) : call();
  if (error == 0 && child) *child = pid;
  return error;
}

VISUM_EXPORT int posix_spawnp(pid_t* child, const char* file, const posix_spawn_file_actions_t* actions,
                              const posix_spawnattr_t* attributes, char* const argv[], char* const envp[]) {
  pid_t pid = 0;
  const auto call = [&] { return VISUM_REAL(posix_spawnp)(&pid, file, actions, attributes, argv, envp); };
  const int error = active() ? starting(call, &pid) : call();
  if (error == 0 && child) *child = pid;
  return error;
}

VISUM_EXPORT int system(const char* command) {
  if (!active() || !command) return VISUM_REAL(system)(command);
  auto* slot = keep_slot(0, ::getpid());
  const int status = await_child("system", -1, [&] { return VISUM_REAL(system)(command); });
  if (slot && status != -1)
    give_up_slot(*slot);
  else if (slot)
    drop_slot(*slot);
  return status;
}

VISUM_EXPORT FILE* popen(const char* command, const char* mode) {
  auto* slot = active() ? keep_slot(0, ::getpid()) : nullptr;
  FILE* pipe = VISUM_REAL(popen)(command, mode);
  if (!pipe && slot) drop_slot(*slot);
  return pipe;
}

VISUM_EXPORT int pclose(FILE* pipe) {
  if (!active()) return VISUM_REAL(pclose)(pipe);
  return await_child("pclose", -1, [&] { return VISUM_REAL(pclose)(pipe); });
}

VISUM_EXPORT pid_t waitpid(pid_t pid, int* status, int options) {
  if (!active() || (options & WNOHANG)) {
    if (active()) note_look("waitpid");
    return VISUM_REAL(waitpid)(pid, status, options);
  }
  return await_child("waitpid", pid, [&] { return VISUM_REAL(waitpid)(pid, status, options); });
}

VISUM_EXPORT pid_t wait(int* status) {
  return waitpid(-1, status, 0);
}

VISUM_EXPORT pid_t wait4(pid_t pid, int* status, int options, rusage* usage) noexcept {
  if (!active() || (options & WNOHANG)) return VISUM_REAL(wait4)(pid, status, options, usage);
  return await_child("wait4", pid, [&] { return VISUM_REAL(wait4)(pid, status, options, usage); });
}

VISUM_EXPORT pid_t wait3(int* status, int options, rusage* usage) noexcept {
  return wait4(-1, status, options, usage);
}

VISUM_EXPORT int waitid(idtype_t type, id_t id, siginfo_t* info, int options) {
  if (!active() || (options & WNOHANG)) return VISUM_REAL(waitid)(type, id, info, options);
  return await_child("waitid", type == P_PID ? static_cast<pid_t>(id) : -1,
                     [&] { return VISUM_REAL(waitid)(type, id, info, options); });
}

VISUM_EXPORT int pause() {
  if (!active()) return VISUM_REAL(pause)();
  return blocked("pause", [] { return VISUM_REAL(pause)(); });
}

VISUM_EXPORT int sigsuspend(const sigset_t* signals) {
  if (!active()) return VISUM_REAL(sigsuspend)(signals);
  return blocked("sigsuspend", [&] { return VISUM_REAL(sigsuspend)(signals); });
}

VISUM_EXPORT int sigwait(const sigset_t* signals, int* number) {
  if (!active()) return VISUM_REAL(sigwait)(signals, number);
  return blocked("sigwait", [&] { return VISUM_REAL(sigwait)(signals, number); });
}

VISUM_EXPORT void _exit(int code) {
  if (active()) leave_process();
  VISUM_REAL(_exit)(code);
  __builtin_unreachable();
}

VISUM_EXPORT void _Exit(int code) {
  _exit(code);
}
