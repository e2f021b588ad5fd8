#include "clients/visum/exec/launch.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "clients/visum/common/exit_code.h"

namespace visum::exec {
namespace {

constexpr long kLongestPoll_ms = 1'000'000;

std::atomic<pid_t> the_program = 0;  // a signal comes on any thread
// The child holds the other end until exec() closes it; it writes a byte where exec() has failed.
int the_failure = -1;
static_assert(std::atomic<pid_t>::is_always_lock_free);

void hand_on(int number) {
  if (const pid_t program = the_program; program > 0) ::kill(program, number);
}

// Ctrl-C reaches the program from the terminal. Other signals are sent to us alone, and meant for it too.
void hand_signals_on() {
  struct sigaction action {};
  action.sa_handler = hand_on;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGINT, SIG_IGN);
}

struct Descriptor {
  explicit Descriptor(int the_fd) : fd(the_fd) {}
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int fd;
};

// For poll().
int milliseconds_until(std::chrono::steady_clock::time_point when) {
  using std::chrono::milliseconds;
  if (when == std::chrono::steady_clock::time_point::max()) return -1;
  const auto left = std::chrono::ceil<milliseconds>(when - std::chrono::steady_clock::now()).count();
  return static_cast<int>(std::clamp<long>(left, 0, kLongestPoll_ms));
}

int reap(pid_t program) {
  int status = 0;
  while (::waitpid(program, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

void report_failure(int fd) {
  [[maybe_unused]] const auto written = ::write(fd, "x", 1);
}

[[noreturn]] void be_program(const std::vector<std::string>& command,
                             const std::vector<Placement>& placements, pid_t parent, int failure) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(cli::kExecFailed);
  try {
    if (!placements.empty()) place_devices(placements);
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "visum: %s\n", error.what());
    report_failure(failure);
    ::_exit(cli::kExecFailed);
  }
  const int code = become(command);
  report_failure(failure);
  ::_exit(code);
}

}  // namespace

int become(std::vector<std::string> command) {
  std::vector<char*> argv;
  for (auto& word : command) argv.push_back(word.data());
  argv.push_back(nullptr);
  for (const int number : {SIGPIPE, SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_DFL);
  ::execvp(argv[0], argv.data());
  const int error = errno;
  std::fprintf(stderr, "visum: cannot run '%s': %s\n", argv[0], std::strerror(error));
  return error == ENOENT ? kNotFound : kNotExecutable;
}

pid_t launch(const std::vector<std::string>& command, const std::vector<Placement>& placements) {
  const pid_t parent = ::getpid();
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw cli::ExitError(cli::kFailed, std::string("cannot make a pipe: ") + std::strerror(errno));
  const pid_t pid = ::fork();
  if (pid < 0)
    throw cli::ExitError(cli::kFailed, std::string("cannot start a process: ") + std::strerror(errno));
  if (pid == 0) be_program(command, placements, parent, ends[1]);
  ::close(ends[1]);
  the_failure = ends[0];
  the_program = pid;
  hand_signals_on();
  return pid;
}

bool was_started() {
  char byte = 0;
  return ::read(the_failure, &byte, 1) == 0;
}

int await_end(pid_t program, std::chrono::steady_clock::time_point give_up, int fd,
              const std::function<void()>& on_readable) {
  using Clock = std::chrono::steady_clock;
  const Descriptor ended(static_cast<int>(::syscall(SYS_pidfd_open, program, 0)));
  pollfd set[] = {{ended.fd, POLLIN, 0}, {fd, POLLIN, 0}};
  try {
    while (set[0].revents == 0 && ended.fd >= 0) {
      if (Clock::now() >= give_up) throw cli::ExitError(cli::kTimedOut, "the program has not ended in time");
      if (::poll(set, 2, milliseconds_until(give_up)) > 0 && set[1].revents != 0) on_readable();
    }
  } catch (...) {
    ::kill(program, SIGKILL);
    reap(program);
    throw;
  }
  return reap(program);
}

int exit_code_of(int status, const std::string& program) {
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int number = WTERMSIG(status);
  std::fprintf(stderr, "visum: '%s' was ended by signal %d (%s)\n", program.c_str(), number,
               ::strsignal(number));
  return cli::kLost;
}

}  // namespace visum::exec
