// visum-mesh: reads a Collada file on standard input and answers its triangles, confined
// (scene/collada/import.h has the answer's form). visumd runs it once for each file; a bad file's worst is
// its end.
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include "server/scene/collada/confine.h"
#include "server/scene/collada/import.h"

namespace {

constexpr std::size_t kMaxDocumentBytes = 64u << 20;

std::string read_all() {
  std::string document;
  std::array<char, 1 << 16> chunk{};
  while (true) {
    const ssize_t got = ::read(STDIN_FILENO, chunk.data(), chunk.size());
    if (got < 0) throw std::runtime_error(std::string("it cannot be read: ") + std::strerror(errno));
    if (got == 0 && document.empty()) throw std::runtime_error("it is empty");
    if (got == 0) return document;
    document.append(chunk.data(), static_cast<std::size_t>(got));
    if (document.size() > kMaxDocumentBytes) throw std::runtime_error("it has more than 64 MiB");
  }
}

void write_all(int fd, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t written = ::write(fd, bytes.data() + at, bytes.size() - at);
    if (written <= 0) return;  // nobody reads any more
    at += static_cast<std::size_t>(written);
  }
}

}  // namespace

int main(int argc, char**) {
  if (argc > 1) {
    write_all(STDERR_FILENO,
              "visum-mesh: reads Collada on standard input, for visumd; it takes no arguments\n");
    return 2;
  }
  int code = EXIT_SUCCESS;
  try {
    visum::collada::confine();
    write_all(STDOUT_FILENO, visum::collada::to_answer(visum::collada::import_collada(read_all())));
  } catch (const std::exception& error) {
    write_all(STDERR_FILENO, error.what());
    code = EXIT_FAILURE;
  }
  ::_exit(code);  // what libraries would do at an ordinary exit is not allowed any more
}
