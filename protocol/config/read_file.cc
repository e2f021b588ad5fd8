#include "protocol/config/read_file.h"

#include <fstream>
#include <system_error>
#include <utility>

namespace visum::config {
namespace {

std::string too_large(std::uintmax_t bytes, std::size_t max_bytes) {
  return "has " + std::to_string(bytes) + " bytes, at most " + std::to_string(max_bytes) + " are read";
}

thread_local FilesNoted* noted = nullptr;
thread_local const FilesGiven* given = nullptr;

std::filesystem::path normal(const std::filesystem::path& path) {
  return std::filesystem::absolute(path).lexically_normal();
}

std::string key_of(const std::filesystem::path& path) {
  return normal(path).string();
}

FileContent read_given(const std::filesystem::path& path, std::size_t max_bytes) {
  const auto file = given->files.find(key_of(path));
  if (file == given->files.end()) return {"", "no such file"};
  if (file->second.size() > max_bytes) return {"", too_large(file->second.size(), max_bytes)};
  return {file->second, ""};
}

FileContent read_disk(const std::filesystem::path& path, std::size_t max_bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) return {"", "no such file"};
  if (error) return {"", "cannot be read: " + error.message()};
  if (std::filesystem::is_directory(status)) return {"", "is a folder, not a file"};
  if (!std::filesystem::is_regular_file(status)) return {"", "is not a regular file"};
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return {"", "cannot be read: " + error.message()};
  if (size > max_bytes) return {"", too_large(size, max_bytes)};

  std::ifstream stream(path, std::ios::binary);
  if (!stream) return {"", "cannot be opened: permission denied or in use"};
  FileContent content;
  content.bytes.resize(size);
  stream.read(content.bytes.data(), static_cast<std::streamsize>(size));
  content.bytes.resize(static_cast<std::size_t>(stream.gcount()));
  // If the file grew since its size was asked for, it is being written, and these bytes are not the whole of
  // it.
  if (stream.bad() || content.bytes.size() != size || stream.peek() != std::ifstream::traits_type::eof())
    return {"", "changed while it was read"};
  return content;
}

}  // namespace

FileContent read_file(const std::filesystem::path& path, std::size_t max_bytes) {
  if (given) return read_given(path, max_bytes);
  auto content = read_disk(path, max_bytes);
  if (noted && content.fault.empty()) noted->files[key_of(path)] = content.bytes;
  return content;
}

void note_file(const std::filesystem::path& path, const std::string& bytes) {
  if (noted) noted->files[key_of(path)] = bytes;
}

bool is_file(const std::filesystem::path& path) {
  if (given) return given->files.contains(key_of(path));
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

std::filesystem::path identity_of(const std::filesystem::path& path) {
  if (given) return normal(path);
  std::error_code error;  // a folder on the way may not be entered
  auto canonical = std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
  return error ? normal(path) : canonical;
}

FilesNoted::FilesNoted() {
  noted = this;
}
FilesNoted::~FilesNoted() {
  noted = nullptr;
}

FilesGiven::FilesGiven(const Files& all) : files(all), before_(given) {
  given = this;
}
FilesGiven::~FilesGiven() {
  given = before_;
}

}  // namespace visum::config
