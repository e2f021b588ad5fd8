#include "clients/visum/exec/threads.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>

namespace visum::exec {
namespace {

// "1234 (a name) S 1 ...": the letter, the parent, and as the 12th and 13th behind the letter utime and
// stime.
ThreadState parse(std::string_view text) {
  const auto name_end = text.rfind(')');
  if (name_end == std::string_view::npos) return {};
  std::istringstream rest{std::string(text.substr(name_end + 1))};
  ThreadState state;
  rest >> state.letter >> state.parent;
  std::string skipped;
  for (int i = 0; i < 9; ++i) rest >> skipped;
  std::uint64_t user = 0, system = 0;
  rest >> user >> system;
  state.ticks = user + system;
  return state;
}

// A call of the kernel that a thread sleeps in; proc_pid_syscall(5).
struct KernelCall {
  long number = -1;
  std::array<std::uint64_t, 6> words{};
  std::uint64_t at = 0;  // the instruction that made it
};

// Nothing where the thread runs, or where the kernel does not let us look.
std::optional<KernelCall> read_call(const std::string& path) {
  std::ifstream file(path);
  KernelCall call;
  if (!(file >> call.number)) return std::nullopt;  // "running"
  std::uint64_t stack = 0;
  file >> std::hex;
  std::string word;
  const auto next = [&] { return file >> word ? std::strtoull(word.c_str(), nullptr, 16) : 0; };
  if (call.number >= 0)
    for (auto& argument : call.words) argument = next();
  stack = next();
  call.at = next();
  return stack != 0 ? std::optional(call) : std::nullopt;
}

// Sleeps, and waits with a time-out that the shim does not drive (SPEC.md, "Limits").
bool is_timed_everywhere(const KernelCall& call) {
  const auto& word = call.words;
  switch (call.number) {
    case SYS_nanosleep:
    case SYS_clock_nanosleep:
      return true;
    case SYS_futex: {
      const auto operation = word[1] & FUTEX_CMD_MASK;
      return (operation == FUTEX_WAIT || operation == FUTEX_WAIT_BITSET) && word[3] != 0;
    }
    case SYS_rt_sigtimedwait:
      return word[2] != 0;
    case SYS_semtimedop:
      return word[3] != 0;
    case SYS_mq_timedreceive:
    case SYS_mq_timedsend:
      return word[4] != 0;
    default:
      return false;
  }
}

// Waits for descriptors. The C library makes some itself, to look up a host's name for example: those wait
// for the world outside, and not for a time.
bool is_timed_by_argument(const KernelCall& call) {
  const auto& word = call.words;
  switch (call.number) {
    case SYS_poll:
      return static_cast<std::int32_t>(word[2]) > 0;
    case SYS_ppoll:
      return word[2] != 0;
    case SYS_select:
    case SYS_pselect6:
      return word[4] != 0;
    case SYS_epoll_wait:
    case SYS_epoll_pwait:
      return static_cast<std::int32_t>(word[3]) > 0;
    case SYS_epoll_pwait2:
      return word[3] != 0;
    default:
      return false;
  }
}

bool is_for_input(const KernelCall& call) {
  switch (call.number) {
    case SYS_read:
    case SYS_readv:
    case SYS_recvfrom:
    case SYS_recvmsg:
    case SYS_accept:
    case SYS_accept4:
      return true;
    default:
      return false;
  }
}

// "7f12a0000000-7f12a0026000 r-xp 00000000 fe:00 123  /usr/lib/x86_64-linux-gnu/libc.so.6"
bool is_in_c_library(const std::string& maps, std::uint64_t address) {
  std::ifstream file(maps);
  for (std::string line; std::getline(file, line);) {
    std::uint64_t begin = 0, end = 0;
    if (std::sscanf(line.c_str(), "%" SCNx64 "-%" SCNx64, &begin, &end) != 2) continue;
    if (address < begin || address >= end) continue;
    const auto name = line.substr(line.rfind('/') + 1);
    return name.starts_with("libc.") || name.starts_with("libc-") || name.starts_with("ld-");
  }
  return false;
}

}  // namespace

Threads::~Threads() {
  for (const auto& [thread, fd] : files_) ::close(fd);
}

ThreadState Threads::state(pid_t process, pid_t thread) {
  const auto [at, is_new] = files_.try_emplace(thread, -1);
  if (is_new) {
    const auto path = "/proc/" + std::to_string(process) + "/task/" + std::to_string(thread) + "/stat";
    at->second = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  }
  std::array<char, 1024> text;
  const auto size = at->second < 0 ? -1 : ::pread(at->second, text.data(), text.size(), 0);
  if (size > 0) return parse({text.data(), static_cast<std::size_t>(size)});
  forget(thread);
  return {};
}

KernelWait Threads::wait_of(pid_t process, pid_t thread) {
  const auto folder = "/proc/" + std::to_string(process);
  const auto call = read_call(folder + "/task/" + std::to_string(thread) + "/syscall");
  if (!call) return KernelWait::kOther;
  const bool timed = is_timed_everywhere(*call) ||
                     (is_timed_by_argument(*call) && !is_in_c_library(folder + "/maps", call->at));
  if (timed) return KernelWait::kHostTime;
  if (call->number == SYS_wait4 || call->number == SYS_waitid) return KernelWait::kChild;
  return is_for_input(*call) ? KernelWait::kInput : KernelWait::kOther;
}

void Threads::forget(pid_t thread) {
  const auto found = files_.find(thread);
  if (found == files_.end()) return;
  if (found->second >= 0) ::close(found->second);
  files_.erase(found);
}

std::string process_name(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/comm");
  std::string name;
  return std::getline(file, name) ? name : "?";
}

}  // namespace visum::exec
