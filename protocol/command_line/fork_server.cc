#include "protocol/command_line/fork_server.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <span>

namespace visum::command_line {
namespace {

constexpr std::size_t kMostBytes = 100'000;  // of a command line; the kernel takes twice as much
constexpr std::size_t kMostDescriptors = 2;

struct Begun {
  pid_t pid = -1;  // -1: there is no copy
};

// Returns false where the other end is gone, or the message is too long.
bool send_with(int socket, const void* bytes, std::size_t size, std::span<const int> descriptors) {
  iovec piece{const_cast<void*>(bytes), size};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int) * kMostDescriptors)> control{};
  msghdr message{};
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  if (!descriptors.empty()) {
    message.msg_control = control.data();
    message.msg_controllen = CMSG_SPACE(descriptors.size_bytes());
    cmsghdr* const header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(descriptors.size_bytes());
    std::memcpy(CMSG_DATA(header), descriptors.data(), descriptors.size_bytes());
  }
  ssize_t sent = 0;
  do {
    sent = ::sendmsg(socket, &message, MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(size);
}

// Returns the number of bytes; 0: the other end is gone; -1: nothing is there (with MSG_DONTWAIT).
// Descriptors that do not come are -1.
ssize_t receive_with(int socket, void* bytes, std::size_t size, std::span<int> descriptors, int flags = 0) {
  iovec piece{bytes, size};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int) * kMostDescriptors)> control{};
  msghdr message{};
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  for (int& descriptor : descriptors) descriptor = -1;
  ssize_t got = 0;
  do {
    got = ::recvmsg(socket, &message, MSG_CMSG_CLOEXEC | flags);
  } while (got < 0 && errno == EINTR);
  if (got < 0) return errno == EAGAIN ? -1 : 0;
  const cmsghdr* const header = CMSG_FIRSTHDR(&message);
  if (header != nullptr && header->cmsg_type == SCM_RIGHTS &&
      header->cmsg_len <= CMSG_LEN(descriptors.size_bytes()))
    std::memcpy(descriptors.data(), CMSG_DATA(header), header->cmsg_len - CMSG_LEN(0));
  return got;
}

// By number: the header of glibc 2.36 does not declare pidfd_open() for C++.
int open_pidfd(pid_t pid) {
  return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
}

// As main() gets them: pointers into `bytes`, which has a zero byte behind each word.
int act_by(std::string& bytes, int (*act)(int argc, char** argv)) {
  std::vector<char*> words;
  for (std::size_t at = 0; at < bytes.size(); at += std::strlen(words.back()) + 1)
    words.push_back(bytes.data() + at);
  words.push_back(nullptr);
  return act(static_cast<int>(words.size()) - 1, words.data());
}

// In the copy: what a process that was just started finds.
void settle_in(pid_t server, int out_fd, int err_fd) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != server) ::_exit(127);  // it died before the line above
  const int null = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  // The server's socket is its standard input, so that the first of these closes it.
  if (null < 0 || ::dup2(null, 0) < 0 || ::dup2(out_fd, 1) < 0 || ::dup2(err_fd, 2) < 0) ::_exit(127);
  for (const int done : {null, out_fd, err_fd}) ::close(done);
}

// Waits for the copy, and kills what is left of its group before its number may be given to another.
ForkEnded await_end(pid_t pid) {
  siginfo_t info{};
  while (::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  ::kill(-pid, SIGKILL);
  ::waitpid(pid, nullptr, 0);
  return {info.si_code != CLD_EXITED, info.si_status};
}

}  // namespace

int serve_forks(int socket, int (*act)(int argc, char** argv)) {
  std::string bytes;
  for (;;) {
    std::array<int, 2> outputs{};
    bytes.resize(kMostBytes);
    const ssize_t got = receive_with(socket, bytes.data(), bytes.size(), outputs);
    if (got <= 0) return 0;
    bytes.resize(static_cast<std::size_t>(got));
    const pid_t server = ::getpid(), pid = ::fork();
    if (pid == 0) {
      settle_in(server, outputs[0], outputs[1]);
      return act_by(bytes, act);
    }
    for (const int output : outputs) ::close(output);
    if (pid > 0) ::setpgid(pid, pid);  // the copy does the same; the first call counts
    const int exit_fd = pid > 0 ? open_pidfd(pid) : -1;
    // Without a pidfd the client could not tell the copy from another process that has its number later.
    if (pid > 0 && exit_fd < 0) ::kill(pid, SIGKILL);
    const Begun begun{exit_fd < 0 ? -1 : pid};
    const bool told = send_with(socket, &begun, sizeof begun, std::span(&exit_fd, exit_fd < 0 ? 0 : 1));
    if (exit_fd >= 0) ::close(exit_fd);
    if (pid < 0) continue;
    const ForkEnded ended = await_end(pid);
    if (!told || (exit_fd >= 0 && !send_with(socket, &ended, sizeof ended, {}))) return 0;
  }
}

std::optional<Forked> ask_for_fork(int socket, const std::vector<std::string>& words, int out_fd,
                                   int err_fd) {
  std::string bytes;
  for (const std::string& word : words) (bytes += word) += '\0';
  const std::array outputs{out_fd, err_fd};
  if (bytes.size() > kMostBytes || !send_with(socket, bytes.data(), bytes.size(), outputs))
    return std::nullopt;
  Begun begun;
  std::array<int, 1> exit_fd{};
  if (receive_with(socket, &begun, sizeof begun, exit_fd) != sizeof begun || begun.pid < 0)
    return std::nullopt;
  return Forked{begun.pid, exit_fd[0]};
}

std::optional<ForkEnded> find_end_of_fork(int socket) {
  ForkEnded ended{true, SIGKILL};
  if (receive_with(socket, &ended, sizeof ended, {}, MSG_DONTWAIT) < 0) return std::nullopt;
  return ended;
}

}  // namespace visum::command_line
