// Reads a file that holds a secret, such as a token or a private key.
#pragma once

#include <filesystem>
#include <string>

namespace visum::config {

// Returns the file's content. It must be a regular file that belongs to this user or to root, and that nobody
// else may read or write; a link to such a file will do. The file that is checked is the one that is read.
// Never waits, also not for a pipe. Throws ConfigError that names the file.
std::string read_secret_file(const std::filesystem::path& path);

}  // namespace visum::config
