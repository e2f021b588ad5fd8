// What a conversion writes: one file, others beside it in a folder of their own, and what got lost on the
// way.
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
  // One sentence each, told once.
  void lose(const std::string& sentence);
  const std::vector<std::string>& losses() const { return losses_; }

  // A name for `other` that is right in the file that is written.
  std::string path_to(const std::filesystem::path& other) const;
  // Keeps a file for write(), in the folder FILE_files; returns its path_to().
  std::string add_file(const std::string& name, std::string bytes);
  // The same of a mesh, once, as OBJ.
  std::string add_mesh(const world::TriangleMesh& mesh);

  // Writes all. Throws ConfigError where that fails; nothing that is there already is replaced but the file
  // itself and those of its folder.
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

// With all its digits, so that it is read as the same bits.
std::string exact(double number);
// "1 2 3"
std::string exact(const double* numbers, std::size_t count, const char* between = " ");

}  // namespace visum::scene
