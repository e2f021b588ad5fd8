// A client's end of a bus: a tty or a TCP connection, and a temporary folder for links.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "hwparts/powercube/can_codec.h"
#include "hwparts/powercube/serial_codec.h"

namespace visum::bus {

// The request for module 3's version, and the answer.
inline const powercube::Telegram kGetVersion{powercube::Telegram::Kind::kGet, 3, {0x0A, 0x1D}};
inline const powercube::Telegram kVersion{powercube::Telegram::Kind::kAnswer, 3, {0x0A, 0x1D, 0x34, 0x46}};

class BusLine {
 public:
  static BusLine tty(const std::filesystem::path& path) {
    BusLine line(::open(path.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    termios settings{};
    EXPECT_EQ(::tcgetattr(line.fd_, &settings), 0) << path;
    ::cfmakeraw(&settings);
    EXPECT_EQ(::tcsetattr(line.fd_, TCSANOW, &settings), 0);
    return line;
  }
  // `name` as in the ready line: "tcp:40123".
  static BusLine tcp(const std::string& name) {
    BusLine line(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    line.connect(name);
    return line;
  }
  // TCP; has a port of its own, and may connect later.
  static BusLine unconnected() {
    BusLine line(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const auto any = loopback(0);
    EXPECT_EQ(::bind(line.fd_, reinterpret_cast<const sockaddr*>(&any), sizeof any), 0);
    return line;
  }
  void connect(const std::string& name) {
    const auto address = loopback(static_cast<std::uint16_t>(std::stoi(name.substr(4))));
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0) << name;
  }
  BusLine(BusLine&& other) noexcept : fd_(std::exchange(other.fd_, -1)), rest_(std::move(other.rest_)) {}
  ~BusLine() {
    if (fd_ >= 0) ::close(fd_);
  }

  void send(const std::string& bytes) {
    ASSERT_EQ(::write(fd_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  void send(const powercube::Telegram& telegram) { send(serial(telegram)); }
  static std::string serial(const powercube::Telegram& telegram) {
    const auto bytes = powercube::encode_serial(telegram);
    return {bytes.data.begin(), bytes.data.begin() + static_cast<std::ptrdiff_t>(bytes.size)};
  }
  static std::string slcan(const powercube::Telegram& telegram) {
    const auto bytes = powercube::encode_slcan(powercube::to_can(telegram));
    return {bytes.data.begin(), bytes.data.begin() + static_cast<std::ptrdiff_t>(bytes.size)};
  }

  // The bytes of one read(); empty: nothing came within `patience_ms`, or the stream ended.
  std::string read_once(int patience_ms = 10'000) {
    pollfd set{fd_, POLLIN, 0};
    if (::poll(&set, 1, patience_ms) <= 0) return {};
    char bytes[512];
    const auto count = ::read(fd_, bytes, sizeof bytes);
    return count > 0 ? std::string(bytes, static_cast<std::size_t>(count)) : std::string();
  }
  // Reads up to and including the byte `end`.
  std::string read_to(char end) {
    for (;;) {
      const auto at = rest_.find(end);
      if (at != std::string::npos) {
        const auto found = rest_.substr(0, at + 1);
        rest_.erase(0, at + 1);
        return found;
      }
      const auto more = read_once();
      if (more.empty()) return {};
      rest_ += more;
    }
  }
  powercube::Telegram ask(const powercube::Telegram& telegram) {
    send(telegram);
    const auto bytes = read_to('\x03');
    const auto decoded =
        powercube::decode_serial({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
    EXPECT_EQ(decoded.progress, powercube::Progress::kComplete) << bytes.size() << " bytes";
    return decoded.telegram;
  }
  int fd() const { return fd_; }
  std::uint32_t port() const {  // TCP: our own
    sockaddr_in own{};
    socklen_t size = sizeof own;
    EXPECT_EQ(::getsockname(fd_, reinterpret_cast<sockaddr*>(&own), &size), 0);
    return ntohs(own.sin_port);
  }

 private:
  static sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    return address;
  }
  explicit BusLine(int fd) : fd_(fd) { EXPECT_GE(fd, 0); }
  int fd_;
  std::string rest_;
};

class LinkFolder {
 public:
  LinkFolder() {
    char name[] = "/tmp/visum-bus-XXXXXX";
    path_ = ::mkdtemp(name);
  }
  ~LinkFolder() { std::filesystem::remove_all(path_); }
  std::string operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace visum::bus
