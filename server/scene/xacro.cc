#include "server/scene/xacro.h"

#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "protocol/config/config.h"
#include "protocol/config/read_file.h"
#include "server/scene/mesh_readers.h"

namespace visum::scene {

namespace fs = std::filesystem;

bool needs_xacro(const fs::path& file, const std::string& text) {
  if (text.find("<xacro:") != std::string::npos) return true;
  return lower_extension(file) == ".xacro" && text.find("${") != std::string::npos;
}

fs::path find_xacro() {
  const char* path = std::getenv("PATH");
  std::istringstream list(path ? path : "");
  for (std::string folder; std::getline(list, folder, ':');) {
    const fs::path program = fs::path(folder) / "xacro";
    if (program.is_absolute() && config::is_file(program) && ::access(program.c_str(), X_OK) == 0)
      return program;
  }
  return {};
}

std::string xacro_command(const fs::path& file) {
  fs::path to = file;
  to.replace_extension();
  if (to.extension() != ".urdf") to += ".urdf";
  if (to == file) to.replace_extension(".plain.urdf");
  return "xacro " + file.string() + " -o " + to.string();
}

std::string expand_xacro(const fs::path& program, const fs::path& file, const ReaderBounds& bounds) {
  try {
    return run_program({program.string(), fs::absolute(file).string()}, bounds);
  } catch (const std::runtime_error& error) {
    throw config::ConfigError({file.string(), 0, ""}, std::string("'xacro' failed: ") + error.what());
  }
}

}  // namespace visum::scene
