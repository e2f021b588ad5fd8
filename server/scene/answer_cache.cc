#include "server/scene/answer_cache.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "server/scene/mesh_readers.h"
#include "server/scene/plain_file.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

// An entry: kMagic, a line "BUILD_ID PATH" for each file of code, an empty line, a line with the input's
// length, the input, the answer, and the XXH3-128 of all that, which tells damage. Change the magic with the
// form. The input stands there since the entry's name, a hash, could be another's.
constexpr std::string_view kMagic = "visum answer 1\n";
constexpr const char* kExtension = ".answer";
constexpr const char* kUnfinished = ".new";  // followed by six letters
constexpr std::size_t kDigestBytes = sizeof(XXH128_canonical_t);
constexpr std::size_t kMaxEntryBytes = 2 * kMaxMeshBytes + (std::size_t{1} << 20);
// These say where the dynamic linker finds libraries, and which it loads before others.
constexpr std::array<const char*, 2> kLibraries{"/etc/ld.so.cache", "/etc/ld.so.preload"};
constexpr std::size_t kMaxLibraries = std::size_t{16} << 20;  // bytes of one of them
constexpr std::int64_t kUnusedS = 24 * 3600;                  // an entry's time is renewed when it is so old
constexpr std::int64_t kAbandonedS = 3600;  // an unfinished file of this age has lost its writer

std::string digest_of(std::string_view bytes) {
  XXH128_canonical_t digest;
  XXH128_canonicalFromHash(&digest, XXH3_128bits(bytes.data(), bytes.size()));
  return {reinterpret_cast<const char*>(digest.digest), kDigestBytes};
}

// Those of which glibc's libm has variants, which may round differently.
std::string instruction_sets() {
  std::string sets;
#ifdef __x86_64__
  for (const bool has : {__builtin_cpu_supports("sse4.1") != 0, __builtin_cpu_supports("fma") != 0,
                         __builtin_cpu_supports("fma4") != 0, __builtin_cpu_supports("avx2") != 0,
                         __builtin_cpu_supports("avx512f") != 0})
    sets += has ? '1' : '0';
#endif
  return sets;
}

std::int64_t seconds_now() {
  return ::time(nullptr);
}

// Takes a line off `text`, without its end. Nothing if there is none.
std::optional<std::string_view> next_line(std::string_view& text) {
  const auto end = text.find('\n');
  if (end == std::string_view::npos) return std::nullopt;
  const auto line = text.substr(0, end);
  text.remove_prefix(end + 1);
  return line;
}

// True if the reader is among the files of code, and each is still of the build that the lines name. Takes
// the lines, and the empty one.
bool is_of_these_builds(const fs::path& reader, std::string_view& entry) {
  bool has_reader = false;
  for (std::size_t files = 0; files <= AnswerCache::kMaxCode; ++files) {
    const auto line = next_line(entry);
    if (!line) return false;
    if (line->empty()) return has_reader;
    const auto space = line->find(' ');
    if (space == 0 || space == std::string_view::npos) return false;
    const fs::path file(line->substr(space + 1));
    if (build_id_of(file) != line->substr(0, space)) return false;
    has_reader = has_reader || file == reader;
  }
  return false;
}

// Takes the input's length and the input. False if it is another one.
bool has_input(std::string_view input, std::string_view& entry) {
  const auto length = next_line(entry);
  if (!length || *length != std::to_string(input.size()) || !entry.starts_with(input)) return false;
  entry.remove_prefix(input.size());
  return true;
}

// Without the digest. Not by config::read_file(): the entry is no file of the scene.
std::optional<std::string> read_entry(const fs::path& path) {
  const PlainFile file(path);
  const auto size = static_cast<std::uintmax_t>(file.status().st_size);
  if (!file.is_open() || file.status().st_uid != ::geteuid() || size < kMagic.size() + kDigestBytes ||
      size > kMaxEntryBytes)
    return std::nullopt;
  std::string bytes = file.read_at(0, size);
  if (bytes.size() != size) return std::nullopt;
  const auto body = std::string_view(bytes).substr(0, size - kDigestBytes);
  if (!body.starts_with(kMagic) || !bytes.ends_with(digest_of(body))) return std::nullopt;
  bytes.resize(size - kDigestBytes);
  return bytes;
}

void renew(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) == 0 && seconds_now() - status.st_mtim.tv_sec > kUnusedS)
    ::utimensat(AT_FDCWD, file.c_str(), nullptr, 0);
}

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// Throws std::runtime_error where the reader is not among the files, or one is not the one that ran.
std::string lines_of(const fs::path& reader, const std::vector<CodeFile>& code) {
  std::string lines;
  for (const auto& [build, path] : code) {
    if (build.empty()) throw std::runtime_error(path + " has no build id");
    if (build_id_of(path) != build) throw std::runtime_error(path + " was replaced");
    lines += build + " " + path + "\n";
  }
  const bool has_reader =
      std::ranges::any_of(code, [&](const CodeFile& file) { return file.path == reader; });
  if (!has_reader || code.size() > AnswerCache::kMaxCode) throw std::runtime_error("its code is not known");
  return lines + "\n";
}

AnswerCache& of_process() {
  static AnswerCache cache;
  return cache;
}

}  // namespace

fs::path usual_cache_folder() {
  const auto folder_of = [](const std::string& text, const char* inside) {
    return fs::path(text).is_absolute() ? fs::path(text) / inside : fs::path();
  };
  const auto text_of = [](const char* variable) {
    const char* value = std::getenv(variable);
    return std::string(value ? value : "");
  };
  const std::string systemd = text_of("CACHE_DIRECTORY");
  for (const auto& folder :
       {folder_of(systemd.substr(0, systemd.find(':')), "visum"),
        folder_of(text_of("XDG_CACHE_HOME"), "visum"), folder_of(text_of("HOME"), ".cache/visum")})
    if (!folder.empty()) return folder;
  return {};
}

AnswerCache::AnswerCache(fs::path folder, std::uintmax_t most_bytes)
    : folder_(folder.is_absolute() ? std::move(folder) : fs::path()), most_bytes_(most_bytes) {}

AnswerCache::Question AnswerCache::ask(const fs::path& reader, std::string_view input) const {
  std::error_code error;
  Question question{fs::canonical(reader, error), input, {}};
  const std::string build = error || folder_.empty() ? "" : build_id_of(question.reader);
  if (build.empty()) return question;
  std::string asked = question.reader.string() + '\0' + build + '\0' + instruction_sets() + digest_of(input);
  for (const char* path : kLibraries) {
    const PlainFile list(path);
    if (list.is_open()) asked += digest_of(list.read_at(0, kMaxLibraries));
    asked += '\0';
  }
  question.entry = folder_ / (hexadecimal(digest_of(asked)) + kExtension);
  return question;
}

std::optional<std::string> AnswerCache::find(const Question& question) const try {
  if (question.entry.empty()) return std::nullopt;
  const auto entry = read_entry(question.entry);
  if (!entry) return std::nullopt;
  std::string_view left = std::string_view(*entry).substr(kMagic.size());
  if (!is_of_these_builds(question.reader, left) || !has_input(question.input, left)) return std::nullopt;
  renew(question.entry);
  return std::string(left);
} catch (const std::exception&) {
  return std::nullopt;  // no memory for it
}

void AnswerCache::keep(const Question& question, std::string_view answer,
                       const std::vector<CodeFile>& code) const {
  if (folder_.empty()) return;
  try {
    if (question.entry.empty()) throw std::runtime_error("it has no build id");
    std::string body(kMagic);
    body += lines_of(question.reader, code) + std::to_string(question.input.size()) + "\n";
    body += question.input;
    body += answer;
    if (body.size() + kDigestBytes > kMaxEntryBytes) throw std::runtime_error("it is too large");
    make_folder();
    write(question.entry, body + digest_of(body));
    if (question.entry.filename().native().front() == '0' || body.size() > most_bytes_ / 64) make_room();
  } catch (const std::exception& error) {
    spdlog::debug("an answer of {} is not kept in {}: {}", question.reader.native(), folder_.native(),
                  error.what());
  }
}

// Root makes no folder in the home of another user, who could not use it.
void AnswerCache::make_folder() const {
  fs::path there;  // as far as there are folders
  struct stat status {};
  std::vector<fs::path> missing;
  for (there = folder_; ::stat(there.c_str(), &status) != 0; there = there.parent_path()) {
    if (errno != ENOENT || !there.has_relative_path()) throw std::runtime_error(std::strerror(errno));
    missing.push_back(there);
  }
  if (status.st_uid != ::geteuid() && (missing.empty() || ::geteuid() == 0))
    throw std::runtime_error(there.native() + " belongs to another user");
  for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder)
    if (::mkdir(folder->c_str(), 0700) != 0 && errno != EEXIST)
      throw std::runtime_error(std::strerror(errno));
}

// The file is complete before it has its name, so that nobody reads a part of it.
void AnswerCache::write(const fs::path& entry, std::string_view body) const {
  std::string unfinished = entry.string() + kUnfinished + "XXXXXX";
  const int fd = ::mkostemp(unfinished.data(), O_CLOEXEC);
  if (fd < 0) throw std::runtime_error(std::strerror(errno));
  const bool whole = write_all(fd, body);
  if (::close(fd) == 0 && whole && ::rename(unfinished.c_str(), entry.c_str()) == 0) return;
  const int reason = errno;
  ::unlink(unfinished.c_str());
  throw std::runtime_error(std::strerror(reason));
}

void AnswerCache::make_room() const try {
  struct Entry {
    std::int64_t time;
    std::uintmax_t bytes;
    fs::path file;
  };
  std::vector<Entry> entries;
  std::uintmax_t bytes = 0;
  std::error_code error;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    struct stat status {};
    const fs::path& file = it->path();
    if (::lstat(file.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    const std::string name = file.filename().string();
    if (file.extension() == kExtension) {
      entries.push_back({status.st_mtim.tv_sec, static_cast<std::uintmax_t>(status.st_blocks) * 512, file});
      bytes += entries.back().bytes;
    } else if (name.find(std::string(kExtension) + kUnfinished) != std::string::npos &&
               seconds_now() - status.st_mtim.tv_sec > kAbandonedS) {
      ::unlink(file.c_str());
    }
  }
  if (bytes <= most_bytes_) return;
  std::ranges::sort(entries, {}, &Entry::time);
  for (const Entry& entry : entries) {
    if (bytes <= most_bytes_ / 4 * 3) break;
    ::unlink(entry.file.c_str());
    bytes -= entry.bytes;
  }
} catch (const std::exception& error) {
  spdlog::debug("{}: {}", folder_.native(), error.what());
}

const AnswerCache& answer_cache() {
  return of_process();
}

void keep_answers_in(fs::path folder) {
  of_process() = AnswerCache(std::move(folder));
}

}  // namespace visum::scene
