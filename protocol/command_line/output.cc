#include "protocol/command_line/output.h"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>

namespace visum::command_line {
namespace {

bool is_reader_gone() {
  pollfd reader{STDOUT_FILENO, 0, 0};
  return ::poll(&reader, 1, 0) == 1 && (reader.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace

std::string find_lost_output() {
  errno = 0;
  std::cout.flush();
  std::fflush(stdout);
  const int cause = errno;  // 0 if an earlier flush has failed already
  if ((!std::cout.bad() && std::ferror(stdout) == 0) || is_reader_gone()) return {};
  return "standard output: cannot be written" +
         (cause == 0 ? std::string() : std::string(": ") + std::strerror(cause));
}

int finish(std::string_view program, int code) {
  const std::string lost = find_lost_output();
  if (lost.empty()) return code;
  std::fprintf(stderr, "%.*s: %s\n", static_cast<int>(program.size()), program.data(), lost.c_str());
  return code == 0 ? kOutputLost : code;
}

void leave(int code) {
#ifdef VISUM_SANITIZED
  std::exit(code);
#else
  std::_Exit(code);
#endif
}

}  // namespace visum::command_line
