#include "server/scene/plain_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace visum::scene {

// It looks first, since some devices act when they are opened, and then again at what it has opened.
PlainFile::PlainFile(const std::filesystem::path& path) {
  if (::stat(path.c_str(), &status_) != 0 || !S_ISREG(status_.st_mode)) return;
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd_ < 0 || (::fstat(fd_, &status_) == 0 && S_ISREG(status_.st_mode))) return;
  ::close(fd_);
  fd_ = -1;
}

PlainFile::~PlainFile() {
  if (fd_ >= 0) ::close(fd_);
}

std::string PlainFile::read_at(std::uint64_t offset, std::size_t bytes) const {
  const auto size = static_cast<std::uint64_t>(status_.st_size);
  std::string read(static_cast<std::size_t>(std::min<std::uint64_t>(bytes, size - std::min(offset, size))),
                   '\0');
  std::size_t got = 0;
  while (got < read.size()) {
    const ssize_t more = ::pread(fd_, read.data() + got, read.size() - got, static_cast<off_t>(offset + got));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) break;
    got += static_cast<std::size_t>(more);
  }
  read.resize(got);
  return read;
}

}  // namespace visum::scene
