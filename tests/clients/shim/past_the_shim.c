/* Sleeps ten times for 20 ms. Linked statically it never loads the shim. With arguments it goes past the
 * functions that the shim replaces:
 *
 *   past_the_shim raw             sleeps by the system call itself, past the C library
 *   past_the_shim timer           is woken by a timer of timer_create()
 *   past_the_shim clone PROGRAM   starts a program by clone(), as posix_spawn() would
 *   past_the_shim clone3 PROGRAM  starts it by syscall(SYS_clone3) and syscall(SYS_execve)
 *   past_the_shim fork PROGRAM    starts it by syscall(SYS_fork) and execv()
 */
#define _GNU_SOURCE
#include <linux/sched.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char** environ;

static long sleep_past_the_library(const struct timespec* length) {
  long result;
  __asm__ volatile("syscall"
                   : "=a"(result)
                   : "a"(SYS_nanosleep), "D"(length), "S"(0)
                   : "rcx", "r11", "memory");
  return result;
}

static int wait_for_timer(void) {
  const struct itimerspec setting = {.it_value = {0, 20000000}};
  sigset_t signals;
  timer_t timer;
  int number;
  sigemptyset(&signals);
  sigaddset(&signals, SIGALRM);
  sigprocmask(SIG_BLOCK, &signals, NULL);
  return timer_create(CLOCK_MONOTONIC, NULL, &timer) != 0 || timer_settime(timer, 0, &setting, NULL) != 0 ||
         sigwait(&signals, &number) != 0;
}

static int become(void* program) {
  char* const words[] = {program, NULL};
  execv(program, words);
  return 127;
}

static long start(const char* how, char* program) {
  static char stack[1 << 16];
  struct clone_args args = {.exit_signal = SIGCHLD};
  char* const words[] = {program, NULL};
  if (strcmp(how, "clone") == 0)
    return clone(become, stack + sizeof stack, CLONE_VM | CLONE_VFORK | SIGCHLD, program);
  if (strcmp(how, "fork") == 0) {
    const long child = syscall(SYS_fork);
    if (child == 0) _exit(become(program));
    return child;
  }
  const long child = syscall(SYS_clone3, &args, sizeof args);
  if (child == 0) {
    syscall(SYS_execve, program, words, environ);
    syscall(SYS_exit_group, 127);
  }
  return child;
}

int main(int argc, char** argv) {
  const struct timespec length = {0, 20000000};
  if (argc > 2) {
    int status = 1;
    const long child = start(argv[1], argv[2]);
    return child < 0 || waitpid((pid_t)child, &status, 0) != child || status != 0;
  }
  if (argc > 1 && strcmp(argv[1], "timer") == 0) return wait_for_timer();
  for (int i = 0; i < 10; ++i)
    if ((argc > 1 ? sleep_past_the_library(&length) : nanosleep(&length, NULL)) != 0) return 1;
  puts("done");
  return 0;
}
