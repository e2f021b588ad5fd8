#include "server/recording/build.h"

namespace visum::recording {

extern const char* const kCommit;  // made at each build, by commit.cmake

namespace {

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#else
  return "gcc " __VERSION__;
#endif
}

std::string instruction_set() {
#if defined(__AVX2__)
  return "x86-64-v3";
#elif defined(__x86_64__)
  return "x86-64";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "unknown";
#endif
}

void compare(const char* what, const std::string& recorded, const std::string& here, std::string& text) {
  if (recorded == here) return;
  text += (text.empty() ? "" : ", ") + std::string(what) + " '" + recorded + "', here '" + here + "'";
}

}  // namespace

Build this_build(const scene::Scene& scene) {
  Build build{VISUM_VERSION, kCommit, compiler(), instruction_set(), {}};
  for (const auto& engine : scene.world.engines) build.engines.push_back(engine.name);
  return build;
}

std::string difference(const Build& recorded, const Build& here) {
  std::string text;
  compare("version", recorded.version, here.version, text);
  compare("commit", recorded.commit, here.commit, text);
  compare("compiler", recorded.compiler, here.compiler, text);
  compare("instruction set", recorded.instruction_set, here.instruction_set, text);
  return text;
}

}  // namespace visum::recording
