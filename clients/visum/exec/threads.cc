#include "clients/visum/exec/threads.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <fstream>
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
