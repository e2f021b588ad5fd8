#include "server/scene/reader_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace visum::scene {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxHeard = 4096;  // bytes of what the program says of itself
constexpr std::size_t kMaxWords = 300;   // of the reason that it gives

class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() { close(); }
  int get() const { return fd_; }
  void close() {
    if (fd_ >= 0) ::close(std::exchange(fd_, -1));
  }

 private:
  int fd_;
};

// Copies the bytes into a memory file, so that the process gets a descriptor wherever they came from.
Descriptor in_memory(std::string_view left) {
  Descriptor memory(::memfd_create("mesh", MFD_CLOEXEC));
  while (!left.empty()) {
    const ssize_t written = ::write(memory.get(), left.data(), left.size());
    if (written <= 0)
      throw std::runtime_error(std::string("no memory to hand it to its reader: ") + std::strerror(errno));
    left.remove_prefix(static_cast<std::size_t>(written));
  }
  ::lseek(memory.get(), 0, SEEK_SET);
  return memory;
}

struct Pipe {
  Descriptor read, write;
};

Pipe make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw std::runtime_error(std::string("no pipe to its reader: ") + std::strerror(errno));
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

// A child process. The destructor kills it and waits for it.
class Child {
 public:
  // `environment` ends with a null.
  Child(const std::vector<std::string>& words, char* const* environment, int in, int out, int err) {
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, err, STDERR_FILENO);
    ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const int error =
        ::posix_spawn(&pid_, words.front().c_str(), &actions, nullptr, arguments.data(), environment);
    ::posix_spawn_file_actions_destroy(&actions);
    if (error != 0)
      throw std::runtime_error("its reader, '" + words.front() +
                               "', cannot be started: " + std::strerror(error));
  }
  ~Child() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // How it ended; nothing if it had not ended by `end`.
  std::optional<int> wait_until(Clock::time_point end) {
    int status = 0;
    const Descriptor process(static_cast<int>(
        ::syscall(SYS_pidfd_open, pid_, 0)));  // -1 where the kernel has none: poll() ignores it
    while (::waitpid(pid_, &status, WNOHANG) == 0) {
      if (Clock::now() >= end) return std::nullopt;
      pollfd ended{process.get(), POLLIN, 0};
      ::poll(&ended, 1, 1);  // ms: it has closed its output and is about to end
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
};

// Appends what there is to read. Returns false at the end.
bool drain(int fd, std::string& to) {
  std::array<char, 1 << 16> chunk;
  const ssize_t got = ::read(fd, chunk.data(), chunk.size());
  if (got < 0) return errno == EINTR;
  to.append(chunk.data(), static_cast<std::size_t>(got));
  return got > 0;
}

[[noreturn]] void fail_late(const ReaderBounds& bounds) {
  throw std::runtime_error("its reader did not finish within " + std::to_string(bounds.deadline.count()) +
                           " ms");
}

struct Heard {
  std::string answer, words;
};

Heard listen(int out, int err, Clock::time_point end, const ReaderBounds& bounds) {
  Heard heard;
  std::array<pollfd, 2> watched{{{out, POLLIN, 0}, {err, POLLIN, 0}}};
  while (watched[0].fd >= 0 || watched[1].fd >= 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    const int ready = left > 0 ? ::poll(watched.data(), watched.size(), static_cast<int>(left)) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) fail_late(bounds);
    if (watched[0].revents != 0 && !drain(out, heard.answer)) watched[0].fd = -1;
    if (watched[1].revents != 0 && !drain(err, heard.words)) watched[1].fd = -1;
    if (heard.answer.size() > bounds.answer_bytes)
      throw std::runtime_error("it has more than " + std::to_string(bounds.answer_bytes >> 20) + " MiB of " +
                               bounds.answer);
    if (heard.words.size() > kMaxHeard) heard.words.resize(kMaxHeard);
  }
  return heard;
}

// The first line that is no warning.
std::string reason_in(const std::string& words) {
  std::istringstream lines(words);
  std::string reason;
  for (std::string line; std::getline(lines, line);)
    if (reason.empty() || (reason.starts_with("warning") && !line.empty())) reason = line;
  return reason.empty() ? "its reader failed without a reason" : reason.substr(0, kMaxWords);
}

// Runs a program with `in` as its standard input.
std::string run(const std::vector<std::string>& words, char* const* environment, Descriptor in,
                const ReaderBounds& bounds) {
  const auto end = Clock::now() + bounds.deadline;
  Pipe out = make_pipe(), err = make_pipe();
  Child child(words, environment, in.get(), out.write.get(), err.write.get());
  for (Descriptor* ours : {&in, &out.write, &err.write}) ours->close();
  Heard heard = listen(out.read.get(), err.read.get(), end, bounds);
  const auto status = child.wait_until(end);
  if (!status) fail_late(bounds);
  if (WIFSIGNALED(*status))
    throw std::runtime_error(std::string("its reader crashed (") + ::strsignal(WTERMSIG(*status)) + ")");
  if (WEXITSTATUS(*status) != 0) throw std::runtime_error(reason_in(heard.words));
  return std::move(heard.answer);
}

}  // namespace

std::string run_reader(const std::string& program, std::string_view input, const ReaderBounds& bounds) {
  std::array<char*, 1> no_environment{nullptr};
  return run({program}, no_environment.data(), in_memory(input), bounds);
}

std::string run_program(const std::vector<std::string>& words, const ReaderBounds& bounds) {
  Descriptor nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  return run(words, ::environ, std::move(nothing), bounds);
}

}  // namespace visum::scene
