#include "tests/architecture/rules.h"

#include <algorithm>
#include <array>

namespace visum::architecture {
namespace {

// The lowest folders come first: clients -> protocol <- hwparts <- server.
const std::vector<Layer> kLayers = {
    {"protocol/config", {}},
    {"protocol/command_line", {"protocol/config"}},
    {"protocol/plugin", {"protocol/config"}},
    {"protocol/processes", {}},
    {"protocol", {"protocol/config"}},
    {"protocol/recording", {"protocol"}},
    {"hwparts", {"protocol/config", "protocol/plugin", "protocol/part_description.h"}},
    {"server/world", {"protocol/config/trig.h"}},
    {"server/collision", {"server/world"}},
    {"server/scene", {"server/world", "hwparts", "protocol/config", "protocol/plugin"}},
    {"server/dynamics",
     {"server/world", "server/collision", "hwparts/joint.h", "protocol/config", "protocol/plugin"}},
    {"server/sensing",
     {"server/world", "server/collision", "server/scene", "server/dynamics", "hwparts", "protocol/config",
      "protocol/plugin"}},
    {"server/cycle",
     {"server/world", "server/collision", "server/scene", "server/dynamics", "server/sensing", "hwparts",
      "protocol/config", "protocol/plugin", "protocol/part_description.h", "protocol/reset_scope.h",
      "protocol/recording/input.h", "protocol/recording/loaded_scene.h", "protocol/recording/state.h"}},
    {"server/recording",
     {"server/world", "server/scene", "server/cycle", "hwparts", "protocol/config", "protocol/plugin",
      "protocol/recording", "protocol/messages.h", "protocol/part_description.h"}},
    {"server/bus",
     {"server/world", "server/scene", "server/cycle", "hwparts", "protocol/config", "protocol/messages.h",
      "protocol/part_description.h", "protocol/plugin"}},
    {"server/gateway",
     {"server/world", "server/collision", "server/scene", "server/dynamics", "server/sensing", "server/cycle",
      "server/recording", "server/bus", "hwparts", "protocol"}},
    {"server/mirror", {"server/world", "server/gateway", "hwparts", "protocol"}},
    {"server", {"protocol", "hwparts"}},
    {"server/programs", {"protocol", "hwparts", "server"}},
    {"server/programs/visum_mesh.cc", {"server/scene/collada", "protocol/command_line"}},
    {"clients", {"protocol"}},
    {"tests", {"protocol", "hwparts", "server", "clients"}},
};

const std::vector<ThirdParty> kThirdParties = {
    {"ode/", {"server/dynamics/ode", "tests"}},
    {"embree3/", {"server/sensing", "tests"}},
    {"fcl/", {"server/collision", "tests"}},
    {"assimp/", {"server/scene/collada", "tests"}},
    {"google/protobuf/", {"protocol", "tests"}},
    {"protocol/visum.pb.h", {"protocol", "tests"}},
    {"visum.pb.h", {"protocol", "tests"}},
    {"recording.pb.h", {"protocol/recording", "tests"}},
    {"boost/asio", {"protocol", "server/gateway", "tests"}},
    {"boost/beast", {"protocol", "tests"}},
    {"openssl/", {"protocol/openssl.h", "protocol/openssl.cc", "protocol/tls.cc", "tests"}},
    {"nettle/", {"protocol/keyed_hash.cc"}},
    {"boost/lockfree/", {"server/gateway", "server/bus", "server/cycle", "server/recording", "tests"}},
    {"yaml-cpp/", {"protocol/config", "tests"}},
    {"urdf_parser/", {"clients/examples", "tests"}},
    {"urdf_model/", {"clients/examples", "tests"}},
    {"urdf_world/", {"clients/examples", "tests"}},
    {"tinyxml2.h", {"server/scene", "clients/examples", "tests"}},
    {"spdlog/", {"protocol", "server", "clients", "tests"}},
    {"png.h", {"server/sensing", "clients", "tests"}},
    {"jpeglib.h", {"server/sensing", "tests"}},
    {"CLI/", {"protocol/command_line", "server/programs", "clients", "tests"}},
    {"zstd.h", {"protocol/recording", "tests"}},
    {"libdeflate.h", {"protocol/recording"}},
    {"xxhash.h", {"server", "clients/visum/campaign", "tests"}},
    {"sqlite3.h", {"clients/visum/campaign", "tests"}},
    {"boost/random/", {"clients/visum/run", "tests"}},
    {"Eigen/", {"hwparts", "server", "clients", "tests"}},
    {"gtest/", {"tests"}},
    {"gmock/", {"tests"}},
    {"benchmark/", {"tests"}},
    {"BulletDynamics/", {"tests/bench/peers"}},
    {"btBulletDynamicsCommon.h", {"tests/bench/peers"}},
    {"dart/", {"tests/bench/peers"}},
    {"kdl/", {"tests/bench/peers"}},
    {"mujoco/", {"tests/bench/peers", "tests/scene/mjcf_peer_test.cc"}},
    {"Simbody.h", {"tests/bench/peers"}},
    {"sanitizer/", {"tests"}},
    {"visum/visum.h", {"tests/install/outside"}},  // ours, as installed
    {"visum/mca/part.h", {"tests/install/outside"}},
    {"visum/plugin.h", {"tests/install/outside"}},
};

const std::vector<std::string> kSystemFolders = {"sys/",   "netinet/", "arpa/", "net/",
                                                 "linux/", "asm/",     "bits/"};
const std::vector<std::string> kSystemHeaders = {
    "assert.h",    "cxxabi.h",   "dirent.h",    "dlfcn.h",    "elf.h",    "errno.h",    "execinfo.h",
    "fcntl.h",     "fenv.h",     "getopt.h",    "glob.h",     "grp.h",    "limits.h",   "link.h",
    "locale.h",    "malloc.h",   "math.h",      "netdb.h",    "poll.h",   "pthread.h",  "pty.h",
    "pwd.h",       "sched.h",    "semaphore.h", "signal.h",   "spawn.h",  "stdarg.h",   "stdbool.h",
    "stddef.h",    "stdint.h",   "stdio.h",     "stdlib.h",   "string.h", "sysexits.h", "syslog.h",
    "termios.h",   "threads.h",  "time.h",      "ucontext.h", "unistd.h", "utmp.h",     "xmmintrin.h",
    "pmmintrin.h", "immintrin.h"};

const std::vector<std::string> kTopLevel = {
    "CHANGELOG.md", "CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "clients", "docker",
    "hwparts",      "models",         "protocol",          "server",  "tests"};
const std::vector<std::string> kTopLevelHidden = {
    ".ci",           ".clang-format", ".clang-tidy",    ".devcontainer", ".dockerignore",
    ".editorconfig", ".git",          ".gitattributes", ".github",       ".gitignore"};
const std::vector<std::string> kUntracked = {
    "build", ".cache", "compile_commands.json", "CMakeUserPresets.json", ".pytest_cache", ".vscode", ".idea"};

const std::vector<std::string> kFoldersWithCode = {"protocol",
                                                   "protocol/config",
                                                   "protocol/command_line",
                                                   "protocol/processes",
                                                   "hwparts",
                                                   "server",
                                                   "server/world",
                                                   "server/scene",
                                                   "server/collision",
                                                   "server/dynamics",
                                                   "server/sensing",
                                                   "server/cycle",
                                                   "server/recording",
                                                   "server/bus",
                                                   "server/gateway",
                                                   "server/mirror",
                                                   "server/programs",
                                                   "protocol/recording",
                                                   "clients",
                                                   "tests"};

// Written in two halves, so that this file passes its own test.
const std::vector<std::string> kUnfinishedWords = {
    "TO"
    "DO",
    "FIX"
    "ME",
    "XX"
    "X",
    "HA"
    "CK"};

const std::vector<std::string> kBannedOpenings = {"What", "Who", "Of", "That", "Whether", "Which"};
const std::array<std::string_view, 8> kSlashExtensions = {".h",  ".c",   ".cc",    ".js",
                                                          ".ts", ".mjs", ".proto", ".css"};
const std::array<std::string_view, 5> kHashExtensions = {".py", ".sh", ".cmake", ".yml", ".yaml"};

// A .proto lists the messages of one protocol, most of its lines comments: it is data, as a schema is.
const std::array<std::string_view, 11> kCodeExtensions = {".h",  ".c",   ".cc",   ".py",    ".sh", ".js",
                                                          ".ts", ".css", ".html", ".cmake", ".in"};

bool any_prefix(const std::vector<std::string>& prefixes, std::string_view text) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](const auto& prefix) { return text.starts_with(prefix); });
}

}  // namespace

std::span<const Layer> layers() {
  return kLayers;
}
std::span<const ThirdParty> third_parties() {
  return kThirdParties;
}
std::span<const std::string> top_level_entries() {
  return kTopLevel;
}
std::span<const std::string> top_level_hidden_entries() {
  return kTopLevelHidden;
}
std::span<const std::string> untracked_entries() {
  return kUntracked;
}
std::span<const std::string> folders_with_code() {
  return kFoldersWithCode;
}
std::span<const std::string> unfinished_words() {
  return kUnfinishedWords;
}

bool is_system_header(std::string_view target) {
  if (target.find('.') == std::string_view::npos && target.find('/') == std::string_view::npos) return true;
  return any_prefix(kSystemFolders, target) ||
         std::find(kSystemHeaders.begin(), kSystemHeaders.end(), target) != kSystemHeaders.end();
}

bool is_code(std::string_view path) {
  const auto name = path.substr(path.rfind('/') + 1);
  const auto dot = name.rfind('.');
  if (dot == std::string_view::npos) return name != "LICENSE" && name != "Dockerfile";
  const auto extension = name.substr(dot);
  return name == "CMakeLists.txt" ||
         std::find(kCodeExtensions.begin(), kCodeExtensions.end(), extension) != kCodeExtensions.end();
}

std::span<const std::string> banned_openings() {
  return kBannedOpenings;
}

std::string_view comment_marker(std::string_view path) {
  const auto name = path.substr(path.rfind('/') + 1);
  const auto dot = name.rfind('.');
  const auto extension = dot == std::string_view::npos ? "" : name.substr(dot);
  const auto is_in = [&](const auto& list) {
    return std::find(list.begin(), list.end(), extension) != list.end();
  };
  if (is_in(kSlashExtensions)) return "//";
  if (is_in(kHashExtensions) || name == "CMakeLists.txt" || name == "Dockerfile") return "#";
  return extension.empty() && is_code(path) ? "#" : "";  // scripts have no extension
}

bool is_model_generator(std::string_view path) {
  const auto name = path.substr(path.rfind('/') + 1);
  return path.starts_with("models/") && name.starts_with("make_") && name.ends_with(".py");
}

}  // namespace visum::architecture
