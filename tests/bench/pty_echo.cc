#include "tests/bench/pty_echo.h"

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace visum::bench {
namespace {

constexpr char kEnd = 'E';

int checked(int result, const char* what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
  return result;
}

}  // namespace

PtyEcho::PtyEcho(std::size_t bytes) : bytes_(bytes, 'x') {
  master_ = checked(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC), "posix_openpt");
  std::array<char, 64> name{};
  checked(::grantpt(master_), "grantpt");
  checked(::unlockpt(master_), "unlockpt");
  checked(-::ptsname_r(master_, name.data(), name.size()), "ptsname");
  slave_ = checked(::open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC), "open");
  termios settings{};
  checked(::tcgetattr(slave_, &settings), "tcgetattr");
  ::cfmakeraw(&settings);
  checked(::tcsetattr(slave_, TCSANOW, &settings), "tcsetattr");
  thread_ = std::thread([this] { serve(); });
}

PtyEcho::~PtyEcho() {
  const bool told = ::write(slave_, &kEnd, 1) == 1;
  if (told) thread_.join();
  if (!told) thread_.detach();
  ::close(slave_);
  ::close(master_);
}

void PtyEcho::serve() const {
  std::array<char, 256> bytes{};
  for (;;) {
    const auto count = ::read(master_, bytes.data(), bytes.size());
    if (count <= 0 || bytes[0] == kEnd) return;
    if (::write(master_, bytes.data(), static_cast<std::size_t>(count)) != count) return;
  }
}

void PtyEcho::round_trip() {
  checked(static_cast<int>(::write(slave_, bytes_.data(), bytes_.size())), "write");
  std::vector<char> answer(bytes_.size());
  for (std::size_t got = 0; got < answer.size();)
    got += static_cast<std::size_t>(
        checked(static_cast<int>(::read(slave_, answer.data() + got, answer.size() - got)), "read"));
}

}  // namespace visum::bench
