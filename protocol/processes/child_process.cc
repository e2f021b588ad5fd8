#include "protocol/processes/child_process.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "protocol/processes/spawn.h"

namespace visum::processes {

using Clock = std::chrono::steady_clock;

namespace {

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

}  // namespace

std::string ExitStatus::text() const {
  if (!by_signal) return "exited with code " + std::to_string(number);
  return "was ended by signal " + std::to_string(number) + " (" + ::strsignal(number) + ")";
}

ChildProcess::ChildProcess(std::string name, const std::vector<std::string>& argv, OnLine on_out,
                           OnLine on_err, int in_fd)
    : name_(std::move(name)) {
  const Spawned spawned = spawn(argv, in_fd);
  pid_ = spawned.pid;
  // By number: the header of glibc 2.36 does not declare pidfd_open() for C++.
  exit_fd_ = static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0));
  out_ = {spawned.out_fd, {}, std::move(on_out)};
  err_ = {spawned.err_fd, {}, std::move(on_err)};
}

ChildProcess::ChildProcess(std::string name, Foreign process, OnLine on_out, OnLine on_err)
    : name_(std::move(name)),
      pid_(process.spawned.pid),
      exit_fd_(process.exit_fd),
      out_{process.spawned.out_fd, {}, std::move(on_out)},
      err_{process.spawned.err_fd, {}, std::move(on_err)},
      find_end_(std::move(process.find_end)) {}

ChildProcess::~ChildProcess() {
  signal(SIGKILL);
  while (!check_exit()) wait_exit(std::chrono::seconds(1));
  close_pipe(out_);
  close_pipe(err_);
  if (exit_fd_ >= 0) ::close(exit_fd_);
}

void ChildProcess::add_to(std::vector<pollfd>& set) const {
  for (const Pipe* pipe : {&out_, &err_}) {
    if (pipe->fd >= 0) set.push_back({pipe->fd, POLLIN, 0});
  }
}

void ChildProcess::drain() {
  read_pipe(out_);
  read_pipe(err_);
}

// Reads one piece at a time: a child that prints without end must not keep us from all other work. A child
// that has ended left at most one pipe full.
void ChildProcess::read_pipe(Pipe& pipe) {
  constexpr int kPipeReads = 16;  // of 4 KiB each: Linux' pipe
  std::array<char, 4096> buffer;
  const int most = exit_ ? kPipeReads : 1;
  for (int reads = 0; reads < most && pipe.fd >= 0; ++reads) {
    const ssize_t got = ::read(pipe.fd, buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0 && errno == EAGAIN) return;
    if (got <= 0) {
      if (!pipe.partial.empty()) take_line(pipe);
      close_pipe(pipe);
      return;
    }
    for (ssize_t i = 0; i < got; ++i) {
      if (buffer[static_cast<std::size_t>(i)] == '\n') {
        take_line(pipe);
      } else if (pipe.partial.size() < kLongestLine) {
        pipe.partial += buffer[static_cast<std::size_t>(i)];
      }
    }
  }
}

void ChildProcess::take_line(Pipe& pipe) {
  const std::string line = std::exchange(pipe.partial, {});
  last_lines_.push_back(line);
  if (last_lines_.size() > kKeptLines) last_lines_.pop_front();
  if (pipe.on_line) pipe.on_line(line);
}

void ChildProcess::close_pipe(Pipe& pipe) {
  if (pipe.fd >= 0) ::close(pipe.fd);
  pipe.fd = -1;
}

// Kills the rest of the group before the ended child is reaped, because until then no other group can get its
// number.
const std::optional<ExitStatus>& ChildProcess::check_exit() {
  if (exit_) return exit_;
  if (find_end_) {
    if ((exit_ = find_end_())) drain();
    return exit_;
  }
  siginfo_t info{};
  if (::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) != 0) {
    if (errno == ECHILD) exit_ = ExitStatus{false, -1};  // already reaped elsewhere: it has ended
    return exit_;
  }
  if (info.si_pid != pid_) return exit_;
  ::kill(-pid_, SIGKILL);
  rusage usage{};
  if (::wait4(pid_, nullptr, 0, &usage) == pid_)
    processor_s_ = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  exit_ = ExitStatus{info.si_code != CLD_EXITED, info.si_status};
  drain();
  return exit_;
}

// Where there is no exit_fd_, a child that only closed its pipes ends no poll, so each poll takes at most 5
// ms.
bool ChildProcess::wait_exit(std::chrono::milliseconds patience) {
  const auto give_up = Clock::now() + patience;
  while (!check_exit()) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(give_up - Clock::now());
    if (left.count() <= 0) return false;
    std::vector<pollfd> set;
    add_to(set);
    if (exit_fd_ >= 0) set.push_back({exit_fd_, POLLIN, 0});
    ::poll(set.data(), set.size(), static_cast<int>(std::min(left, std::chrono::milliseconds(5)).count()));
    drain();
  }
  return true;
}

// By its pidfd where it is not ours to reap: its number may be another's by now. Its group goes when it ends.
void ChildProcess::signal(int number) const {
  if (exit_) return;
  if (find_end_)
    ::syscall(SYS_pidfd_send_signal, exit_fd_, number, nullptr, 0);
  else
    ::kill(-pid_, number);
}

void ChildProcess::stop(std::chrono::milliseconds patience) {
  signal(SIGINT);
  if (wait_exit(patience)) return;
  signal(SIGKILL);
  while (!wait_exit(std::chrono::seconds(1))) {
  }
}

}  // namespace visum::processes
