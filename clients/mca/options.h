// The command line of a part, with the options that MCA2's users know, and the configuration file.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace visum::mca {

class Group;

struct Options {
  std::string name{};               // of the part
  std::int64_t period_ns = 0;       // 0: the part's own
  double time_scale = 1.0;          // 2: a cycle takes twice its period; LoopTime() does not know
  int debug_level = 0;              // 0: no debug lines
  std::set<std::string> domains{};  // their lines are shown; empty: all
  std::set<std::string> modules{};  // by path: all their lines are shown, whatever level and domain
  std::string config_file{};
  std::string version_check{};       // HOST:PORT of another part or of a server
  std::vector<std::string> lower{};  // PART@HOST:PORT, the parts below
  int port = -1;                     // for the parts above; 0: any free one; -1: none
  // In lockstep: the parts above to wait for.
  int uppers = 1;                          // how many of them;
  std::vector<std::string> upper_names{};  // or their names
  double join_timeout_s = 60.0;            // how long all of them may take to join
  double upper_timeout_s = 10.0;           // how long each of them may take for a cycle
  double connect_timeout_s = 10.0;
  std::string token_file{};
};

// Reads the options; options.name is the name that the part has otherwise. Returns the exit code if the
// program is to end at once.
std::optional<int> parse(const std::string& about, int argc, const char* const* argv, Options& options);

// Sets the parameters that the file names, by module:
//   Arm/Ramp:
//     Speed: 0.5
// The part's own stand under the part's name. Throws config::ConfigError with file and line.
void apply_config_file(const std::string& file, Group& part);

// Reads "10ms", "0.005s", "250us" or "250µs". Throws std::invalid_argument.
std::int64_t period_of(const std::string& text);

}  // namespace visum::mca
