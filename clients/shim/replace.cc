// The exec() family: a process goes on as another program. Its slot is marked until that program has loaded
// the shim, so that the scheduler learns of one that never does (linked statically, setuid, or started with
// an environment without LD_PRELOAD).
#include <errno.h>
#include <stdarg.h>
#include <unistd.h>

#include <array>

#include "clients/shim/real.h"
#include "clients/shim/turns.h"

using namespace visum::shim;

namespace {

// exec() returns only where it has failed.
template <typename Call>
int replacing(Call call) {
  if (!active()) return call();
  mine().flags |= kReplacing;
  const int result = call();
  mine().flags &= ~kReplacing;
  return result;
}

// The arguments of execl() and its like, up to the null pointer that ends them.
constexpr std::size_t kMostArguments = 4096;
struct Arguments {
  std::array<char*, kMostArguments + 1> words{};
  bool fit = true;
};

void collect(Arguments& arguments, const char* first, va_list* list) {
  std::size_t count = 0;
  for (const char* word = first; word; word = va_arg(*list, const char*)) {
    arguments.fit = count < kMostArguments;
    if (!arguments.fit) return;
    arguments.words[count++] = const_cast<char*>(word);
  }
}

int too_many() {
  errno = E2BIG;
  return -1;
}

}  // namespace

VISUM_EXPORT int execve(const char* path, char* const argv[], char* const envp[]) noexcept {
  return replacing([&] { return VISUM_REAL(execve)(path, argv, envp); });
}

VISUM_EXPORT int fexecve(int fd, char* const argv[], char* const envp[]) noexcept {
  return replacing([&] { return VISUM_REAL(fexecve)(fd, argv, envp); });
}

VISUM_EXPORT int execveat(int folder, const char* path, char* const argv[], char* const envp[],
                          int flags) noexcept {
  return replacing([&] { return VISUM_REAL(execveat)(folder, path, argv, envp, flags); });
}

VISUM_EXPORT int execv(const char* path, char* const argv[]) noexcept {
  return replacing([&] { return VISUM_REAL(execv)(path, argv); });
}

VISUM_EXPORT int execvp(const char* file, char* const argv[]) noexcept {
  return replacing([&] { return VISUM_REAL(execvp)(file, argv); });
}

VISUM_EXPORT int execvpe(const char* file, char* const argv[], char* const envp[]) noexcept {
  return replacing([&] { return VISUM_REAL(execvpe)(file, argv, envp); });
}

VISUM_EXPORT int execl(const char* path, const char* first, ...) noexcept {
  Arguments arguments;
  va_list list;
  va_start(list, first);
  collect(arguments, first, &list);
  va_end(list);
  return arguments.fit ? execv(path, arguments.words.data()) : too_many();
}

VISUM_EXPORT int execlp(const char* file, const char* first, ...) noexcept {
  Arguments arguments;
  va_list list;
  va_start(list, first);
  collect(arguments, first, &list);
  va_end(list);
  return arguments.fit ? execvp(file, arguments.words.data()) : too_many();
}

VISUM_EXPORT int execle(const char* path, const char* first, ...) noexcept {
  Arguments arguments;
  va_list list;
  va_start(list, first);
  collect(arguments, first, &list);
  char* const* environment = arguments.fit ? va_arg(list, char* const*) : nullptr;
  va_end(list);
  return arguments.fit ? execve(path, arguments.words.data(), environment) : too_many();
}
