#include "server/scene/answer_cache.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "server/scene/build_id.h"
#include "server/scene/mesh_readers.h"
#include "server/scene/plain_file.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

// An entry: kMagic, a line "BUILD_ID PATH" for each file of code, an empty line, the answer, and the XXH3-128
// of all that. Change the magic with the form.
constexpr std::string_view kMagic = "visum answer 1\n";
constexpr const char* kExtension = ".answer";
constexpr const char* kUnfinished = ".new";  // followed by six letters
constexpr std::size_t kDigestBytes = sizeof(XXH128_canonical_t);
constexpr std::size_t kMaxCode = 64;  // files; visum-mesh has some ten
constexpr std::size_t kMaxEntryBytes = kMaxMeshBytes + (std::size_t{1} << 20);
constexpr const char* kLibraries = "/etc/ld.so.cache";        // where the dynamic linker finds libraries
constexpr std::size_t kMaxLibraries = std::size_t{16} << 20;  // bytes of that
constexpr std::int64_t kClockSlackS = 2;                      // the times of files come from a coarser clock
constexpr std::int64_t kUnusedS = 24 * 3600;                  // an entry's time is renewed when it is so old
constexpr std::int64_t kAbandonedS = 3600;  // an unfinished file of this age has lost its writer

std::string digest_of(std::string_view bytes) {
  XXH128_canonical_t digest;
  XXH128_canonicalFromHash(&digest, XXH3_128bits(bytes.data(), bytes.size()));
  return {reinterpret_cast<const char*>(digest.digest), kDigestBytes};
}

std::string hexadecimal_digest_of(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  char digits[33];
  std::snprintf(digits, sizeof digits, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return digits;
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

// True if each file of code is still of the build that the lines name. Takes the lines, and the empty one.
bool is_of_these_builds(std::string_view& entry) {
  for (std::size_t files = 0; files <= kMaxCode; ++files) {
    const auto line = next_line(entry);
    if (!line) return false;
    if (line->empty()) return files > 0;
    const auto space = line->find(' ');
    if (space == 0 || space == std::string_view::npos ||
        build_id_of(std::string(line->substr(space + 1))) != line->substr(0, space))
      return false;
  }
  return false;
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

// Throws std::runtime_error where a file has no build id, or may not be the one that ran.
std::string head_of(const std::vector<fs::path>& code, std::int64_t begun) {
  if (code.empty() || code.size() > kMaxCode) throw std::runtime_error("its code is not known");
  std::string head(kMagic);
  for (const fs::path& file : code) {
    struct stat status {};
    const std::string id = build_id_of(file);
    if (id.empty()) throw std::runtime_error(file.string() + " has no build id");
    if (::stat(file.c_str(), &status) != 0 || status.st_ctim.tv_sec >= begun - kClockSlackS)
      throw std::runtime_error(file.string() + " may have been replaced");
    head += id + " " + file.string() + "\n";
  }
  return head + "\n";
}

AnswerCache& of_process() {
  static AnswerCache cache;
  return cache;
}

}  // namespace

fs::path usual_cache_folder() {
  const auto absolute = [](const char* variable) {
    const char* value = std::getenv(variable);
    const std::string text = value ? value : "";
    const fs::path folder = text.substr(0, text.find(':'));  // systemd's may be a list
    return folder.is_absolute() ? folder.lexically_normal() : fs::path();
  };
  if (const auto folder = absolute("CACHE_DIRECTORY"); !folder.empty()) return folder;
  if (const auto folder = absolute("XDG_CACHE_HOME"); !folder.empty()) return folder / "visum";
  if (const auto folder = absolute("HOME"); !folder.empty()) return folder / ".cache" / "visum";
  return {};
}

fs::path AnswerCache::entry_of(const fs::path& reader, std::string_view input) const {
  std::error_code error;
  const fs::path program = fs::canonical(reader, error);
  const std::string build = error || folder_.empty() ? "" : build_id_of(program);
  if (build.empty()) return {};
  const PlainFile libraries(kLibraries);
  std::string asked;
  for (const std::string& part :
       {program.string(), build, instruction_sets(),
        libraries.is_open() ? digest_of(libraries.read_at(0, kMaxLibraries)) : "", digest_of(input)})
    asked += part + '\0';
  return folder_ / (hexadecimal_digest_of(asked) + kExtension);
}

std::optional<std::string> AnswerCache::find(const fs::path& reader, std::string_view input) const try {
  const fs::path file = entry_of(reader, input);
  if (file.empty()) return std::nullopt;
  const auto entry = read_entry(file);
  if (!entry) return std::nullopt;
  std::string_view left = std::string_view(*entry).substr(kMagic.size());
  if (!is_of_these_builds(left)) return std::nullopt;
  renew(file);
  return std::string(left);
} catch (const std::exception&) {
  return std::nullopt;  // no memory for it
}

void AnswerCache::keep(const fs::path& reader, std::string_view input, std::string_view answer,
                       const std::vector<fs::path>& code, std::int64_t begun) const {
  if (folder_.empty()) return;
  try {
    const fs::path entry = entry_of(reader, input);
    if (entry.empty()) throw std::runtime_error(reader.string() + " has no build id");
    const std::string body = head_of(code, begun) + std::string(answer);
    if (body.size() + kDigestBytes > kMaxEntryBytes) throw std::runtime_error("it is too large");
    make_folder();
    write(entry, body);
    if (entry.filename().string().starts_with('0') || body.size() > most_bytes_ / 64) make_room();
  } catch (const std::exception& error) {
    spdlog::debug("an answer of {} is not kept in {}: {}", reader.string(), folder_.string(), error.what());
  }
}

// Root makes no folder in the home of another user, who could not use it.
void AnswerCache::make_folder() const {
  fs::path there = folder_;
  while (!fs::exists(there)) there = there.parent_path();
  struct stat status {};
  if (::stat(there.c_str(), &status) != 0) throw std::runtime_error(std::strerror(errno));
  const bool ours = status.st_uid == ::geteuid();
  if (!ours && (there == folder_ || ::geteuid() == 0))
    throw std::runtime_error(there.string() + " belongs to another user");
  fs::create_directories(folder_.parent_path());
  if (::mkdir(folder_.c_str(), 0700) != 0 && errno != EEXIST) throw std::runtime_error(std::strerror(errno));
}

// The file is complete before it has its name, so that nobody reads a part of it.
void AnswerCache::write(const fs::path& entry, std::string_view body) const {
  std::string unfinished = entry.string() + kUnfinished + "XXXXXX";
  const int fd = ::mkostemp(unfinished.data(), O_CLOEXEC);
  if (fd < 0) throw std::runtime_error(std::strerror(errno));
  const bool whole = write_all(fd, body) && write_all(fd, digest_of(body));
  if (::close(fd) == 0 && whole && ::rename(unfinished.c_str(), entry.c_str()) == 0) return;
  const int reason = errno;
  ::unlink(unfinished.c_str());
  throw std::runtime_error(std::strerror(reason));
}

void AnswerCache::make_room() const {
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
      entries.push_back({status.st_mtim.tv_sec, static_cast<std::uintmax_t>(status.st_size), file});
      bytes += entries.back().bytes;
    } else if (name.find(std::string(kExtension) + kUnfinished) != std::string::npos &&
               seconds_now() - status.st_mtim.tv_sec > kAbandonedS) {
      ::unlink(file.c_str());
    }
  }
  if (bytes <= most_bytes_) return;
  std::ranges::sort(entries, {}, [](const Entry& entry) { return std::pair(entry.time, entry.file); });
  for (const Entry& entry : entries) {
    if (bytes <= most_bytes_ / 4 * 3) break;
    ::unlink(entry.file.c_str());
    bytes -= entry.bytes;
  }
}

const AnswerCache& answer_cache() {
  return of_process();
}

void keep_answers_in(fs::path folder) {
  of_process() = AnswerCache(std::move(folder));
}

}  // namespace visum::scene
