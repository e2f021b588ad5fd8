#include "clients/visum/exec/launch.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "clients/visum/common/exit_code.h"

namespace visum::exec {
namespace {

constexpr long kLongestPoll_ms = 1'000'000;

volatile pid_t the_program = 0;

void hand_on(int number) {
  if (the_program > 0) ::kill(the_program, number);
}

// Ctrl-C reaches the program from the terminal; who ends only us means it too.
void hand_signals_on() {
  struct sigaction action {};
  action.sa_handler = hand_on;
  action.sa_flags = SA_RESTART;
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGINT, SIG_IGN);
}

[[noreturn]] void be_program(const std::vector<std::string>& command,
                             const std::vector<Placement>& placements, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(cli::kExecFailed);
  try {
    if (!placements.empty()) place_devices(placements);
  } catch (const std::runtime_error& error) {
    std::fprintf(stderr, "visum: %s\n", error.what());
    ::_exit(cli::kExecFailed);
  }
  ::_exit(become(command));
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
  const pid_t pid = ::fork();
  if (pid < 0)
    throw cli::ExitError(cli::kFailed, std::string("cannot start a process: ") + std::strerror(errno));
  if (pid == 0) be_program(command, placements, parent);
  the_program = pid;
  hand_signals_on();
  return pid;
}

int await_end(pid_t program, std::chrono::steady_clock::time_point give_up) {
  using Clock = std::chrono::steady_clock;
  const bool forever = give_up == Clock::time_point::max();
  const int fd = static_cast<int>(::syscall(SYS_pidfd_open, program, 0));
  pollfd ended{fd, POLLIN, 0};
  for (auto left = give_up - Clock::now(); fd >= 0 && left > Clock::duration::zero();
       left = give_up - Clock::now()) {
    const auto ms = forever ? -1 : std::chrono::ceil<std::chrono::milliseconds>(left).count();
    if (::poll(&ended, 1, static_cast<int>(std::min<long>(ms, kLongestPoll_ms))) != 0) break;
  }
  if (fd >= 0) ::close(fd);
  const bool late = Clock::now() >= give_up;
  if (late) ::kill(program, SIGKILL);
  int status = 0;
  while (::waitpid(program, &status, 0) < 0 && errno == EINTR) {
  }
  if (late) throw cli::ExitError(cli::kTimedOut, "the program has not ended in time");
  return status;
}

int exit_code_of(int status, const std::string& program) {
  if (WIFEXITED(status)) return WEXITSTATUS(status);
  const int number = WTERMSIG(status);
  std::fprintf(stderr, "visum: '%s' was ended by signal %d (%s)\n", program.c_str(), number,
               ::strsignal(number));
  return cli::kLost;
}

}  // namespace visum::exec
