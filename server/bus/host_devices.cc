#include "server/bus/host_devices.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "server/bus/bus_link.h"

namespace visum::bus {
namespace {

struct Rate {
  const char* name;
  speed_t speed;
};
constexpr Rate kSerialRates[] = {{"1200", B1200},   {"2400", B2400},    {"4800", B4800},
                                 {"9600", B9600},   {"19200", B19200},  {"38400", B38400},
                                 {"57600", B57600}, {"115200", B115200}};
// Lawicel's commands for kbit/s.
constexpr std::pair<const char*, const char*> kCanRates[] = {
    {"125", "S4"}, {"250", "S5"}, {"500", "S6"}, {"1000", "S8"}};
constexpr timeval kConnectTimeout{0, 200'000};  // a lost device server is tried again between ticks

[[noreturn]] void fail(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

// "PATH,OPTION" as its two halves.
std::pair<std::string, std::string> split(const std::string& where, const std::string& otherwise) {
  const auto comma = where.rfind(',');
  if (comma == std::string::npos) return {where, otherwise};
  return {where.substr(0, comma), where.substr(comma + 1)};
}

// Raw, 8N1, no handshake, and for us alone. Where another program has the device, its settings stay.
int open_tty(const std::string& path, speed_t speed) {
  const int fd = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) fail("cannot open " + path);
  termios settings{};
  bool good = ::flock(fd, LOCK_EX | LOCK_NB) == 0 && ::tcgetattr(fd, &settings) == 0;
  if (good) {
    ::cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS | CSTOPB);
    good = ::cfsetispeed(&settings, speed) == 0 && ::cfsetospeed(&settings, speed) == 0 &&
           ::tcsetattr(fd, TCSANOW, &settings) == 0 && ::tcflush(fd, TCIFLUSH) == 0;
  }
  if (good) return fd;
  const int error = errno;
  ::close(fd);
  errno = error;
  if (error == EWOULDBLOCK) throw std::runtime_error(path + " is in use by another program");
  fail("cannot set up " + path);
}

int connect_to(const addrinfo& address) {
  const int fd = ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC, address.ai_protocol);
  if (fd < 0) return -1;
  const int on = 1;
  ::setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &kConnectTimeout, sizeof kConnectTimeout);
  if (::connect(fd, address.ai_addr, address.ai_addrlen) == 0 &&
      ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on) == 0 &&
      ::fcntl(fd, F_SETFL, O_NONBLOCK) == 0)
    return fd;
  const int error = errno;
  ::close(fd);
  errno = error == EINPROGRESS ? ETIMEDOUT : error;
  return -1;
}

}  // namespace

std::unique_ptr<Channel> open_serial_device(const std::string& where) {
  const auto halves = split(where, "38400");
  const auto &path = halves.first, &rate = halves.second;
  const auto row = std::ranges::find_if(kSerialRates, [&](const Rate& known) { return rate == known.name; });
  if (row == std::end(kSerialRates)) {
    std::string known;
    for (const auto& entry : kSerialRates) known += (known.empty() ? "" : ", ") + std::string(entry.name);
    throw std::runtime_error("'" + rate + "' is no bit rate of these modules; there are: " + known);
  }
  return std::make_unique<Channel>(open_tty(path, row->speed), Speech::kSerial);
}

std::unique_ptr<Channel> open_slcan_device(const std::string& where) {
  const auto halves = split(where, "500");
  const auto &path = halves.first, &rate = halves.second;
  const auto row = std::ranges::find_if(kCanRates, [&](const auto& known) { return rate == known.first; });
  if (row == std::end(kCanRates))
    throw std::runtime_error("'" + rate +
                             "' is no bit rate of these modules' CAN; there are: 125, 250, 500, 1000");
  const int fd = open_tty(path, B115200);
  auto channel = std::make_unique<Channel>(fd, Speech::kSlcanHost);
  const auto opening = "\rC\r" + std::string(row->second) + "\rO\r";
  if (::write(fd, opening.data(), opening.size()) != static_cast<ssize_t>(opening.size()))
    fail("cannot write to " + path);
  return channel;
}

std::unique_ptr<Channel> connect_to_bus(const std::string& where) {
  const auto colon = where.rfind(':');
  const auto host = colon == std::string::npos ? std::string("127.0.0.1") : where.substr(0, colon);
  const auto port = colon == std::string::npos ? where : where.substr(colon + 1);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found); error != 0)
    throw std::runtime_error("'" + where + "' is no address HOST:PORT: " + ::gai_strerror(error));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> list(found, ::freeaddrinfo);
  int fd = -1;
  for (const auto* address = found; address && fd < 0; address = address->ai_next) fd = connect_to(*address);
  if (fd < 0) fail("cannot connect to " + host + ":" + port);
  return std::make_unique<Channel>(fd, Speech::kSerial);
}

std::unique_ptr<Channel> open_can_interface(const std::string& interface) {
  return std::move(open_socketcan(interface)->channels().front());
}

}  // namespace visum::bus
