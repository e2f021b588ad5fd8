// A disk that has room for the beginning of a recording, and then is full: while it lives, no file of this
// process may grow beyond a few KiB.
#pragma once

#include <signal.h>
#include <sys/resource.h>

#include "tests/support/temp_files.h"

namespace visum::storm {

class FullDisk {
 public:
  static constexpr rlim_t kRoomBytes = 48u << 10;

  FullDisk() {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit small = before_;
    small.rlim_cur = kRoomBytes;
    if (::setrlimit(RLIMIT_FSIZE, &small) != 0) throw std::runtime_error("cannot limit the size of files");
  }
  ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before_); }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

  std::filesystem::path file() const { return files_.folder() / "run.mcap"; }
  bool is_full() const { return std::filesystem::file_size(file()) == kRoomBytes; }

 private:
  test::TempFiles files_;
  rlimit before_{};
};

}  // namespace visum::storm
