// visum-mesh: reads a Collada file from standard input and writes its triangles to standard output
// (scene/collada/import.h describes their form). visumd runs it once for each file. It confines itself before
// it reads, so the worst that a bad file can do is to end this process.
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

#include "protocol/command_line/output.h"
#include "protocol/command_line/parse.h"
#include "server/scene/collada/code.h"
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

// Returns false where not all of it can be written.
bool write_all(int fd, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t written = ::write(fd, bytes.data() + at, bytes.size() - at);
    if (written <= 0) return false;
    at += static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1) {
    CLI::App app{"Reads a Collada mesh from standard input, for visumd", "visum-mesh"};
    visum::command_line::add_version(app);
    app.footer(
        "Writes the mesh's triangles to standard output. visumd starts this program by itself for each "
        "Collada "
        "file of a scene: it has bounded time and memory, and may make no system calls beyond what that "
        "needs.\n"
        "Exit codes: 0 done, 1 the file is bad, 2 bad usage.");
    return visum::command_line::finish("visum-mesh", visum::command_line::parse(app, argc, argv).value_or(0));
  }
  int code = EXIT_SUCCESS;
  try {
    const auto whose = visum::collada::code_lines();
    visum::collada::confine();
    const auto answer = visum::collada::to_answer(visum::collada::import_collada(read_all()));
    if (!write_all(STDOUT_FILENO, whose) || !write_all(STDOUT_FILENO, answer))
      throw std::runtime_error(std::string("standard output: cannot be written: ") + std::strerror(errno));
  } catch (const std::exception& error) {
    write_all(STDERR_FILENO, error.what());
    code = EXIT_FAILURE;
  }
  ::_exit(code);  // libraries would make forbidden system calls at an ordinary exit
}
