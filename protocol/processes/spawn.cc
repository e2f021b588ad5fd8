#include "protocol/processes/spawn.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

namespace visum::processes {
namespace {

void close_all(std::initializer_list<int> descriptors) {
  for (const int fd : descriptors) ::close(fd);
}

// A program has no handlers of ours, and is ended by what ends programs. We may ignore SIGXFSZ, which it then
// does, too: a file at its limit of size is an error for it, not its death.
void forget_handlers(const sigset_t& mask) {
  struct sigaction standard {};
  standard.sa_handler = SIG_DFL;
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) ::sigaction(signal, &standard, nullptr);
  ::sigprocmask(SIG_SETMASK, &mask, nullptr);
}

// Between vfork and exec, on the parent's memory: only system calls, and nothing is written but its own
// variables.
[[noreturn]] void become(char* const* argv, pid_t parent, int in_fd, const PipeEnds& out, const PipeEnds& err,
                         int report_fd, const sigset_t& mask) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it died before the line above
  forget_handlers(mask);
  if (in_fd < 0) in_fd = ::open("/dev/null", O_RDONLY);
  // dup2 makes copies that stay open on exec.
  if (in_fd >= 0 && ::dup2(in_fd, 0) >= 0 && ::dup2(out.write, 1) >= 0 && ::dup2(err.write, 2) >= 0) {
    ::close_range(3, ~0U, CLOSE_RANGE_CLOEXEC);  // ours are so already; what we inherited need not be
    ::execvp(argv[0], argv);
  }
  const int error = errno;
  // Nothing is lost where this fails: the parent then sees an exit code of 127.
  [[maybe_unused]] const auto written = ::write(report_fd, &error, sizeof error);
  ::_exit(127);
}

// fork would copy the tables of our memory, and each of our threads would then fault its pages in again: a
// world in real time would stand still meanwhile. vfork stops only the thread that calls it, until exec.
// Signals wait for as long, since a handler would run on our memory, too. Returns -1 with errno.
pid_t start(char* const* argv, int in_fd, const PipeEnds& out, const PipeEnds& err, int report_fd) {
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t parent = ::getpid();
  const pid_t pid = ::vfork();
  if (pid == 0) become(argv, parent, in_fd, out, err, report_fd, before);
  const int error = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return pid;
}

// 0 once exec succeeded (which closed the pipe), else its errno.
int read_report(int fd) {
  int error = 0;
  ssize_t got = 0;
  do {
    got = ::read(fd, &error, sizeof error);
  } while (got < 0 && errno == EINTR);
  return got == static_cast<ssize_t>(sizeof error) ? error : 0;
}

}  // namespace

PipeEnds make_pipe(const std::string& program) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) {
    throw std::runtime_error("cannot start '" + program + "': pipe: " + std::strerror(errno));
  }
  return {ends[0], ends[1]};
}

Spawned spawn(const std::vector<std::string>& argv, int in_fd) {
  std::vector<char*> arguments;
  for (const std::string& argument : argv) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  const PipeEnds out = make_pipe(argv[0]), err = make_pipe(argv[0]), report = make_pipe(argv[0]);
  const pid_t pid = start(arguments.data(), in_fd, out, err, report.write);
  const int fork_error = pid < 0 ? errno : 0;
  close_all({out.write, err.write, report.write});
  const int error = pid < 0 ? fork_error : read_report(report.read);
  ::close(report.read);
  if (error != 0) {
    close_all({out.read, err.read});
    if (pid > 0) ::waitpid(pid, nullptr, 0);
    throw std::runtime_error("cannot start '" + argv[0] + "': " + std::strerror(error));
  }
  for (const int fd : {out.read, err.read}) ::fcntl(fd, F_SETFL, O_NONBLOCK);
  return {pid, out.read, err.read};
}

}  // namespace visum::processes
