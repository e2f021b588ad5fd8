// The source tree as the architecture test sees it: every text file with its lines and its includes.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace visum::architecture {

struct Include {
  std::string target;  // as written between the quotes or brackets
  bool angled = false;
  int line = 0;  // from 1
};

struct SourceFile {
  std::string path;  // from the root, "server/world/ids.h"
  std::vector<std::string> lines;
  std::vector<Include> includes;  // of C++ files only
};

struct SourceTree {
  std::map<std::string, SourceFile> files;  // by path
  std::vector<std::string> top_level;       // names of the root's entries, sorted
};

std::string folder_of(const std::string& path);     // "server/world", "" for a file of the root
std::string extension_of(const std::string& path);  // ".h", or "" if it has no extension
bool is_cpp(const std::string& path);
bool is_header(const std::string& path);
bool starts_with_folder(const std::string& path, const std::string& folder);  // the path is in it or is it

// Makes a file from text. Tests use it for files that are not on disk.
SourceFile make_file(const std::string& path, const std::string& text);

// Reads all text files below the root, except build results, hidden files and folders, and Python's caches.
// Throws std::filesystem::filesystem_error if the root cannot be read.
SourceTree read_tree(const std::filesystem::path& root);

}  // namespace visum::architecture
