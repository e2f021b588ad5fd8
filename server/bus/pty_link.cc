// A pseudo terminal, with a symbolic link to it at a path that the user chose. For programs that open a tty
// by its name.
#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "server/bus/bus_link.h"

namespace visum::bus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

// A link that leads nowhere was left behind by a daemon that was killed, and may go. Anything else belongs to
// another program.
void make_link(const fs::path& path, const std::string& tty) {
  std::error_code error;
  if (fs::is_symlink(fs::symlink_status(path, error)) && !fs::exists(path, error)) fs::remove(path, error);
  if (::symlink(tty.c_str(), path.c_str()) == 0) return;
  if (errno == EEXIST)
    throw std::runtime_error("cannot make a link at '" + path.string() +
                             "': something is there already, perhaps another daemon's; remove it first");
  fail("cannot make a link at '" + path.string() + "'");
}

class PtyLink : public BusLink {
 public:
  PtyLink(const char* kind, const std::string& path, Speech speech)
      : kind_(kind), path_(path), speech_(speech) {
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (master_ < 0) fail("cannot open a pseudo terminal");
    try {
      set_up();
    } catch (...) {
      ::close(master_);
      if (slave_ >= 0) ::close(slave_);
      throw;
    }
  }
  ~PtyLink() override {
    std::error_code error;
    if (fs::read_symlink(path_, error).string() == tty_) fs::remove(path_, error);
    ::close(slave_);
    if (!handed_out_) ::close(master_);
  }

  std::string name() const override { return std::string(kind_) + ":" + path_; }
  std::string address() const override { return std::string(kind_) + ":" + fs::absolute(path_).string(); }
  std::vector<std::unique_ptr<Channel>> channels() override {
    std::vector<std::unique_ptr<Channel>> all;
    all.push_back(std::make_unique<Channel>(master_, speech_, Channel::Reads::kPackets));
    handed_out_ = true;
    return all;
  }

 private:
  void set_up() {
    std::array<char, 64> tty{};
    if (::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
        ::ptsname_r(master_, tty.data(), tty.size()) != 0)
      fail("cannot set up a pseudo terminal");
    tty_ = tty.data();
    // We hold it open as well, so that clients may come and go.
    slave_ = ::open(tty_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios settings{};
    if (slave_ < 0 || ::tcgetattr(slave_, &settings) != 0) fail("cannot open " + tty_);
    ::cfmakeraw(&settings);
    const int on = 1;
    if (::tcsetattr(slave_, TCSANOW, &settings) != 0 || ::fcntl(master_, F_SETFL, O_NONBLOCK) != 0 ||
        ::ioctl(master_, TIOCPKT, &on) != 0)
      fail("cannot set up " + tty_);
    make_link(path_, tty_);
  }

  const char* kind_;
  std::string path_, tty_;
  Speech speech_;
  int master_ = -1, slave_ = -1;
  bool handed_out_ = false;
};

}  // namespace

std::unique_ptr<BusLink> open_pty(const std::string& path) {
  return std::make_unique<PtyLink>("pty", path, Speech::kSerial);
}

std::unique_ptr<BusLink> open_slcan(const std::string& path) {
  return std::make_unique<PtyLink>("slcan", path, Speech::kSlcan);
}

}  // namespace visum::bus
