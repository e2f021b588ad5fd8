#include "server/scene/collada/confine.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

namespace visum::collada {
namespace {

constexpr rlim_t kCpuSeconds = 20;

void check(int result, const char* what) {
  if (result != 0) throw std::runtime_error(std::string(what) + ": " + std::strerror(errno));
}

void limit(int resource, rlim_t most, const char* what) {
  const rlimit both{most, most};
  check(::setrlimit(static_cast<__rlimit_resource_t>(resource), &both), what);
}

constexpr rlim_t kMemoryBytes = rlim_t{1} << 30;

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
#error "name the architecture as the kernel's audit does"
#endif

constexpr std::array kAllowed{SYS_read,   SYS_write,      SYS_brk,          SYS_mmap,     SYS_munmap,
                              SYS_mremap, SYS_madvise,    SYS_mprotect,     SYS_futex,    SYS_clock_gettime,
                              SYS_exit,   SYS_exit_group, SYS_rt_sigreturn, SYS_getrandom};

// Installs a filter in the kernel: the numbers above pass, all other calls kill the process.
void allow_few_calls() {
  using std::uint32_t;
  constexpr auto number_at = static_cast<uint32_t>(offsetof(seccomp_data, nr));
  constexpr auto architecture_at = static_cast<uint32_t>(offsetof(seccomp_data, arch));
  const auto kill = sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS);
  std::vector<sock_filter> program{
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, architecture_at),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0),
      kill,
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, number_at),
  };
  for (const auto number : kAllowed) {
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<uint32_t>(number), 0, 1));
    program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  }
  program.push_back(kill);
  const sock_fprog whole{static_cast<unsigned short>(program.size()), program.data()};
  check(::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0), "no new privileges");
  check(::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &whole), "filter of system calls");
}

}  // namespace

void confine() {
  check(::prctl(PR_SET_PDEATHSIG, SIGKILL), "death with the parent");
  limit(RLIMIT_CORE, 0, "core file");
  limit(RLIMIT_CPU, kCpuSeconds, "processor time");
  if (!kForbids) return;
  limit(RLIMIT_AS, kMemoryBytes, "memory");
  allow_few_calls();
}

}  // namespace visum::collada
