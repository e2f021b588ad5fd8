#include "clients/visum/run/spawn.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

namespace visum::run {
namespace {

void close_all(std::initializer_list<int> descriptors) {
  for (const int fd : descriptors) ::close(fd);
}

// Between fork and exec: only calls that are safe there.
[[noreturn]] void become(char* const* argv, pid_t parent, int in_fd, const PipeEnds& out, const PipeEnds& err,
                         int report_fd) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it died before the line above
  for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) ::signal(signal, SIG_DFL);
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
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid == 0) become(arguments.data(), parent, in_fd, out, err, report.write);
  const int fork_error = pid < 0 ? errno : 0;
  close_all({out.write, err.write, report.write});
  if (pid > 0) ::setpgid(pid, pid);  // the child does the same; the first call counts
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

}  // namespace visum::run
