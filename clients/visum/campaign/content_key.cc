#include "clients/visum/campaign/content_key.h"

#include <unistd.h>
#include <xxhash.h>

#include <cstdlib>
#include <sstream>

#include "clients/visum/common/format.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/placeholders.h"
#include "protocol/config/expand.h"
#include "protocol/config/flow.h"
#include "protocol/config/read_file.h"

namespace visum::campaign {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 30;

std::string hash_bytes(const std::string& bytes) {
  return cli::hex(XXH64(bytes.data(), bytes.size(), 0));
}

// As a shell finds it.
std::filesystem::path found_in_path(const std::string& program) {
  if (program.find('/') != program.npos) return program;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (const auto file = std::filesystem::path(folder) / program; ::access(file.c_str(), X_OK) == 0)
      return file;
  return program;
}

// The placeholders that lead to files. The others stand for places that differ from run to run.
std::map<std::string, std::string> places(const run::Scenario& scenario) {
  const auto folder = scenario.file.parent_path();
  std::map<std::string, std::string> values{{"scenario_dir", folder.empty() ? "." : folder.string()},
                                            {"scene", scenario.scene.string()},
                                            {"bin", run::own_folder().string()}};
  for (const char* other : {"connect", "host", "port", "seed", "clock"}) values[other] = other;
  for (const auto& [part, kind] : scenario.buses) values["bus." + part] = kind;
  return values;
}

}  // namespace

std::string hash_text(const std::string& text) {
  return hash_bytes(text);
}

std::string build_id() {
  std::string hashes;
  for (const char* program : {"visum", "visumd"}) {
    const auto content = config::read_file(found_in_path(run::find_server(program).string()), kMaxBytes);
    hashes += content.fault.empty() ? hash_bytes(content.bytes) : "?";
  }
  return std::string(VISUM_VERSION) + " " + hash_text(hashes);
}

std::string deciding(const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words)
    if (word != "--no-cache") text += '\0' + word;
  return text;
}

ContentKeys::ContentKeys(const config::Node& root, const std::vector<std::string>& words,
                         const std::string& build)
    : root_(root), common_(build + deciding(words)) {}

std::string ContentKeys::key(const run::Scenario& scenario, const config::Variables& variables) {
  config::ExpansionBudget budget;
  std::string text = common_;
  for (const auto& name : root_.keys())
    if (name != "sweep" && name != "sampling" && name != "decide" && name != "search")
      text += '\0' + name + '\0' + config::flow(config::expanded(root_.get(name), variables, budget));
  const auto values = places(scenario);
  for (const auto& controller : scenario.controllers) {
    for (std::size_t i = 0; i < controller.command.size(); ++i) {
      const std::string word = run::fill_in(controller.command[i], values);
      text += '\0' + hash_of(i == 0 ? found_in_path(word) : std::filesystem::path(word));
    }
  }
  return hash_text(text);
}

const std::string& ContentKeys::hash_of(const std::filesystem::path& file) {
  const auto [known, fresh] = hashes_.try_emplace(file);
  if (fresh)
    if (const auto content = config::read_file(file, kMaxBytes); content.fault.empty())
      known->second = hash_bytes(content.bytes);
  return known->second;
}

std::string ContentKeys::find_change(const std::vector<std::pair<std::string, std::string>>& files) {
  for (const auto& [path, hash] : files)
    if (hash_of(path) != hash) return path;
  return {};
}

}  // namespace visum::campaign
