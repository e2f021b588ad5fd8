#include "server/gateway/page_files.h"

#include <xxhash.h>

#include <cstdio>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "protocol/config/read_file.h"

namespace visum::gateway {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFiles = 256;
constexpr std::size_t kMaxFileBytes = 32u << 20;
constexpr std::string_view kCompressed = ".gz";
constexpr std::string_view kHashedFolder = "/assets/";  // vite.config: names there hold a hash of the content

std::string content_type_of(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  if (extension == ".html") return "text/html; charset=utf-8";
  if (extension == ".js") return "text/javascript; charset=utf-8";
  if (extension == ".css") return "text/css; charset=utf-8";
  if (extension == ".svg") return "image/svg+xml";
  if (extension == ".png") return "image/png";
  if (extension == ".json") return "application/json";
  return "application/octet-stream";
}

std::string read_bytes(const fs::path& file) {
  auto content = config::read_file(file, kMaxFileBytes);
  if (!content.fault.empty()) throw std::runtime_error(file.string() + ": " + content.fault);
  return std::move(content.bytes);
}

std::string etag_of(const std::string& bytes) {
  char text[24];
  std::snprintf(text, sizeof text, "\"%016llx\"",
                static_cast<unsigned long long>(XXH64(bytes.data(), bytes.size(), 0)));
  return text;
}

}  // namespace

PageFiles::PageFiles(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "index.html", error))
    throw std::runtime_error("the page's folder '" + folder.string() + "' holds no index.html");
  for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    const fs::directory_entry& entry = *at;
    if (std::error_code none; !entry.is_regular_file(none)) continue;
    std::string path = "/" + entry.path().lexically_relative(folder).generic_string();
    const bool compressed = path.ends_with(kCompressed);
    if (compressed) path.resize(path.size() - kCompressed.size());
    File& file = files_[path];
    (compressed ? file.gzip : file.plain) = read_bytes(entry.path());
    if (files_.size() > kMaxFiles)
      throw std::runtime_error("the page's folder '" + folder.string() + "' holds too many files");
  }
  if (error)
    throw std::runtime_error("the page's folder '" + folder.string() +
                             "' cannot be read: " + error.message());
  for (auto& [path, file] : files_) {
    file.content_type = content_type_of(path);
    file.etag = etag_of(file.plain);
    file.immutable = path.starts_with(kHashedFolder);
  }
}

protocol::WebReply PageFiles::get(const protocol::WebRequest& request) const {
  const auto found = files_.find(request.path == "/" ? "/index.html" : request.path);
  protocol::WebReply reply;
  if (found == files_.end()) {
    reply.status = 404;
    reply.text = "there is no " + request.path + "\n";
    return reply;
  }
  const File& file = found->second;
  reply.content_type = file.content_type;
  reply.etag = file.etag;
  reply.immutable = file.immutable;
  reply.gzip = request.takes_gzip && !file.gzip.empty();
  if (request.if_none_match == file.etag)
    reply.status = 304;
  else
    reply.fixed = reply.gzip ? file.gzip : file.plain;
  return reply;
}

fs::path find_page_folder() {
  std::error_code error;
  const fs::path bin = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  for (const fs::path& folder : {bin / "../share/visum/page", bin / "../page"})
    if (fs::is_regular_file(folder / "index.html", error)) return fs::weakly_canonical(folder, error);
  return {};
}

}  // namespace visum::gateway
