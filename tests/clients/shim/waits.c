#define _GNU_SOURCE
#include "tests/clients/shim/waits.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static struct timespec after(clockid_t clock, long ms) {
  struct timespec time;
  clock_gettime(clock, &time);
  time.tv_sec += ms / 1000;
  time.tv_nsec += ms % 1000 * 1000000L;
  if (time.tv_nsec >= 1000000000L) {
    ++time.tv_sec;
    time.tv_nsec -= 1000000000L;
  }
  return time;
}

static bool is_past(const struct timespec* until) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec > until->tv_sec || (now.tv_sec == until->tv_sec && now.tv_nsec >= until->tv_nsec);
}

static void wait_usleep(long ms) {
  usleep((useconds_t)(ms * 1000));
}

/* By a grid of its own: it does not drift. */
static void wait_absolute(long ms) {
  static struct timespec next;
  if (next.tv_sec == 0) clock_gettime(CLOCK_MONOTONIC, &next);
  next.tv_nsec += ms * 1000000L;
  while (next.tv_nsec >= 1000000000L) {
    ++next.tv_sec;
    next.tv_nsec -= 1000000000L;
  }
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL) == EINTR) {
  }
}

static void wait_poll(long ms) {
  int ends[2];
  if (pipe(ends) != 0) abort();
  struct pollfd set = {ends[0], POLLIN, 0};
  if (poll(&set, 1, (int)ms) != 0) abort();
  close(ends[0]);
  close(ends[1]);
}

static void wait_select(long ms) {
  struct timeval length = {ms / 1000, ms % 1000 * 1000};
  select(0, NULL, NULL, NULL, &length);
}

static void wait_condition(long ms) {
  static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  static pthread_cond_t condition = PTHREAD_COND_INITIALIZER;
  const struct timespec until = after(CLOCK_REALTIME, ms);
  pthread_mutex_lock(&mutex);
  while (pthread_cond_timedwait(&condition, &mutex, &until) != ETIMEDOUT) {
  }
  pthread_mutex_unlock(&mutex);
}

static void wait_semaphore(long ms) {
  sem_t semaphore;
  sem_init(&semaphore, 0, 0);
  const struct timespec until = after(CLOCK_REALTIME, ms);
  if (sem_timedwait(&semaphore, &until) != -1 || errno != ETIMEDOUT) abort();
}

static void wait_mutex(long ms) {
  static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
  pthread_mutex_lock(&mutex);
  const struct timespec until = after(CLOCK_REALTIME, ms);
  if (pthread_mutex_timedlock(&mutex, &until) != ETIMEDOUT) abort();
  pthread_mutex_unlock(&mutex);
}

static void wait_timerfd(long ms) {
  static int epoll = -1, timer = -1;
  uint64_t count;
  struct epoll_event event = {.events = EPOLLIN};
  if (timer < 0) {
    epoll = epoll_create1(0);
    timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK);
    const struct itimerspec setting = {{0, ms * 1000000L}, {0, ms * 1000000L}};
    if (timerfd_settime(timer, 0, &setting, NULL) != 0) abort();
    if (epoll_ctl(epoll, EPOLL_CTL_ADD, timer, &event) != 0) abort();
  }
  if (epoll_wait(epoll, &event, 1, -1) != 1 || read(timer, &count, sizeof count) != 8 || count != 1) abort();
}

static volatile sig_atomic_t alarms = 0;
static void on_alarm(int number) {
  (void)number;
  ++alarms;
}

static void wait_alarm(long ms) {
  static bool set = false;
  static int seen = 0;
  if (!set) {
    struct sigaction action = {.sa_handler = on_alarm};
    sigaction(SIGALRM, &action, NULL);
    const struct itimerval setting = {{0, ms * 1000}, {0, ms * 1000}};
    setitimer(ITIMER_REAL, &setting, NULL);
    set = true;
  }
  while (alarms == seen) pause();
  seen = alarms;
}

static void wait_receive(long ms) {
  int ends[2];
  char byte;
  const struct timeval length = {ms / 1000, ms % 1000 * 1000};
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) abort();
  setsockopt(ends[0], SOL_SOCKET, SO_RCVTIMEO, &length, sizeof length);
  if (recv(ends[0], &byte, 1, 0) != -1 || errno != EAGAIN) abort();
  close(ends[0]);
  close(ends[1]);
}

static void wait_spin(long ms) {
  const struct timespec until = after(CLOCK_MONOTONIC, ms);
  while (!is_past(&until)) {
  }
}

static void wait_yield(long ms) {
  const struct timespec until = after(CLOCK_MONOTONIC, ms);
  while (!is_past(&until)) sched_yield();
}

static void wait_for_child(long ms, pid_t (*await)(pid_t, int*)) {
  int status;
  const pid_t child = fork();
  if (child == 0) {
    usleep((useconds_t)(ms * 1000));
    _exit(7);
  }
  if (await(child, &status) != child || WEXITSTATUS(status) != 7) abort();
}

static pid_t await_by_library(pid_t child, int* status) {
  return waitpid(child, status, 0);
}

static void wait_fork(long ms) {
  wait_for_child(ms, await_by_library);
}

/* Past the library: whoever keeps the time has to find out that this thread waits, and what for. */
static pid_t await_by_kernel(pid_t child, int* status) {
  return (pid_t)syscall(SYS_wait4, child, status, 0, NULL);
}

static void wait_kernel(long ms) {
  wait_for_child(ms, await_by_kernel);
}

static void wait_command(long ms) {
  char command[64] = "sleep 0.000";
  command[8] = (char)('0' + ms / 100 % 10);
  command[9] = (char)('0' + ms / 10 % 10);
  command[10] = (char)('0' + ms % 10);
  if (system(command) != 0) abort();
}

static void* sleep_in_thread(void* ms) {
  usleep((useconds_t)((long)(intptr_t)ms * 1000));
  return ms;
}

static void wait_join(long ms) {
  pthread_t thread;
  void* result;
  if (pthread_create(&thread, NULL, sleep_in_thread, (void*)(intptr_t)ms) != 0) abort();
  if (pthread_join(thread, &result) != 0 || result != (void*)(intptr_t)ms) abort();
}

/* A thread of its own signals, with a pipe, a condition and a semaphore in turns. */
static int signal_pipe[2];
static sem_t signal_semaphore;
static pthread_mutex_t signal_mutex = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t signal_condition = PTHREAD_COND_INITIALIZER;
static int signalled = 0;

static void* signal_for_ever(void* ms) {
  for (int k = 0;; ++k) {
    usleep((useconds_t)((long)(intptr_t)ms * 1000));
    if (k % 3 == 0 && write(signal_pipe[1], "x", 1) != 1) abort();
    if (k % 3 == 1) sem_post(&signal_semaphore);
    if (k % 3 == 2) {
      pthread_mutex_lock(&signal_mutex);
      ++signalled;
      pthread_cond_signal(&signal_condition);
      pthread_mutex_unlock(&signal_mutex);
    }
  }
  return NULL;
}

static void wait_thread(long ms) {
  static int k = 0, seen = 0;
  char byte;
  if (k == 0) {
    pthread_t thread;
    sem_init(&signal_semaphore, 0, 0);
    if (pipe(signal_pipe) != 0 || pthread_create(&thread, NULL, signal_for_ever, (void*)(intptr_t)ms) != 0)
      abort();
  }
  if (k % 3 == 0 && read(signal_pipe[0], &byte, 1) != 1) abort();
  if (k % 3 == 1) sem_wait(&signal_semaphore);
  if (k % 3 == 2) {
    pthread_mutex_lock(&signal_mutex);
    while (signalled == seen) pthread_cond_wait(&signal_condition, &signal_mutex);
    seen = signalled;
    pthread_mutex_unlock(&signal_mutex);
  }
  ++k;
}

const struct kind kinds[] = {{"usleep", wait_usleep},       {"absolute", wait_absolute},
                             {"poll", wait_poll},           {"select", wait_select},
                             {"condition", wait_condition}, {"semaphore", wait_semaphore},
                             {"mutex", wait_mutex},         {"timerfd", wait_timerfd},
                             {"alarm", wait_alarm},         {"receive", wait_receive},
                             {"spin", wait_spin},           {"yield", wait_yield},
                             {"fork", wait_fork},           {"command", wait_command},
                             {"join", wait_join},           {"thread", wait_thread},
                             {"future", wait_future},       {"future_until", wait_future_until},
                             {"promise", wait_promise},     {"acquire", wait_acquire},
                             {"kernel", wait_kernel},       {NULL, NULL}};
