// Collects what a conversion writes: one file, companion files in a folder of their own, and a list of
// losses. Nothing is written before write().
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/world/world_model.h"

namespace visum::scene {

class Output {
 public:
  explicit Output(std::filesystem::path file);

  const std::filesystem::path& file() const { return file_; }
  // Notes a loss in one sentence. The same sentence is noted once.
  void lose(const std::string& sentence);
  const std::vector<std::string>& losses() const { return losses_; }

  // The path to `other`, as it must stand in the file that is written.
  std::string path_to(const std::filesystem::path& other) const;
  // Keeps a companion file for write(), in the folder FILE_files. Returns its path_to().
  std::string add_file(const std::string& name, std::string bytes);
  // As add_file() for a mesh, which is written as OBJ, and only once.
  std::string add_mesh(const world::TriangleMesh& mesh);

  // Writes all files. Replaces only the file itself and companions in its folder. Throws ConfigError if that
  // fails.
  void write(const std::string& text) const;

 private:
  struct Companion {
    std::string name, bytes;
    const void* source;
  };

  std::filesystem::path file_, folder_;
  std::vector<std::string> losses_;
  std::vector<Companion> companions_;
};

// With as many digits as are needed to read the same bits again.
std::string exact(double number);
// "1 2 3"
std::string exact(const double* numbers, std::size_t count, const char* between = " ");

}  // namespace visum::scene
