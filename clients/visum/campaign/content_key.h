// Tells whether a run would be the same as one that was made: by the content of all that it depends on. One
// thread.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clients/visum/run/scenario.h"
#include "protocol/config/config.h"
#include "protocol/config/expand.h"

namespace visum::campaign {

// Those of a run's options that its result may depend on, as one text. Kept meshes change no bit of it, so
// --no-cache is not among them.
std::string deciding(const std::vector<std::string>& words);

class ContentKeys {
 public:
  // `words`: the options of every run. `build`: of visum and visumd.
  ContentKeys(const config::Node& root, const std::vector<std::string>& words, const std::string& build);

  // Hashes a run's scenario with `variables`, the sweep's values, filled in, options, build, and the
  // controllers' programs and the files that their commands name. The scene's files are for find_change(). A
  // file that a controller opens on its own account is not known.
  std::string key(const run::Scenario& scenario, const config::Variables& variables);
  // The first file whose content differs from then, of paths with the XXH64 of their content; empty: none.
  std::string find_change(const std::vector<std::pair<std::string, std::string>>& files);

 private:
  // XXH64 of the content, as hexadecimal digits; empty: no file that can be read. Read once.
  const std::string& hash_of(const std::filesystem::path& file);

  const config::Node root_;
  const std::string common_;
  std::map<std::filesystem::path, std::string> hashes_;
};

// "0.2.0 1f3a...": Visum's version, and XXH64 of the programs visum and visumd.
std::string build_id();
// XXH64 of a text, as hexadecimal digits.
std::string hash_text(const std::string& text);

}  // namespace visum::campaign
