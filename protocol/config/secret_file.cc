#include "protocol/config/secret_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "protocol/config/config.h"

namespace visum::config {
namespace {

constexpr std::size_t kMaxBytes = 1u << 20;

struct Descriptor {
  explicit Descriptor(int the_fd) : fd(the_fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
  const int fd;
};

// Says why the opened file must not hold a secret; empty: it may.
std::string fault_of(int fd) {
  struct stat info {};
  if (::fstat(fd, &info) != 0) return std::string("cannot be read: ") + std::strerror(errno);
  if (!S_ISREG(info.st_mode)) return "is not a regular file";
  if (info.st_uid != ::geteuid() && info.st_uid != 0)
    return "belongs to another user (id " + std::to_string(info.st_uid) + "); chown makes it yours";
  if ((info.st_mode & (S_IRWXG | S_IRWXO)) != 0) return "others may read it; chmod 600 makes it yours alone";
  if (static_cast<std::size_t>(info.st_size) > kMaxBytes)
    return "has more than " + std::to_string(kMaxBytes) + " bytes";
  return {};
}

}  // namespace

std::string read_secret_file(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& why) { throw ConfigError({path.string(), 0, ""}, why); };
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.fd < 0) fail(std::string("cannot be read: ") + std::strerror(errno));
  if (const std::string fault = fault_of(file.fd); !fault.empty()) fail(fault);
  std::string content;
  char piece[4096];
  for (ssize_t got = 0; (got = ::read(file.fd, piece, sizeof piece)) != 0;) {
    if (got < 0) fail(std::string("cannot be read: ") + std::strerror(errno));
    content.append(piece, static_cast<std::size_t>(got));
    if (content.size() > kMaxBytes) fail("grows while it is read");
  }
  return content;
}

}  // namespace visum::config
