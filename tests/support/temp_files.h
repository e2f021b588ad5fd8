// A temporary folder for one test, with the files that the test writes. Errors are shown without the folder's
// name.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "protocol/config/config.h"

namespace visum::test {

class TempFiles {
 public:
  TempFiles() {
    std::string folder = (std::filesystem::temp_directory_path() / "visum_test_XXXXXX").string();
    if (mkdtemp(folder.data()) == nullptr) throw std::runtime_error("cannot make " + folder);
    folder_ = folder;
  }
  ~TempFiles() { std::filesystem::remove_all(folder_); }
  TempFiles(const TempFiles&) = delete;
  TempFiles& operator=(const TempFiles&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  std::string read(const std::string& name) const {
    std::stringstream text;
    text << std::ifstream(folder_ / name, std::ios::binary).rdbuf();
    return text.str();
  }
  const std::filesystem::path& folder() const { return folder_; }

  // The text of the ConfigError that `call` throws, without this folder's name; "no error" if it throws none.
  template <typename Call>
  std::string error_of(const Call& call) const {
    try {
      call();
    } catch (const config::ConfigError& error) {
      return without_folder(error.what());
    }
    return "no error";
  }

 private:
  std::string without_folder(std::string text) const {
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
      text.erase(at, prefix.size());
    return text;
  }

  std::filesystem::path folder_;
};

}  // namespace visum::test
