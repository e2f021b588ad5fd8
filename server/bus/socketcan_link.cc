// A CAN interface of the kernel: real, virtual (vcan), or an adapter behind slcand.
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "server/bus/bus_link.h"

namespace visum::bus {
namespace {

class SocketCanLink : public BusLink {
 public:
  explicit SocketCanLink(const std::string& interface)
      : interface_(interface), fd_(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW)) {
    if (fd_ < 0 && (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT))
      throw std::runtime_error("socketcan:" + interface +
                               ": this kernel has no SocketCAN (AF_CAN); slcan: and tcp: need none");
    if (fd_ < 0) fail();
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    if (address.can_ifindex == 0 || ::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      const int error = errno;
      ::close(fd_);
      errno = error;
      fail();
    }
  }
  ~SocketCanLink() override {
    if (!handed_out_) ::close(fd_);
  }

  std::string name() const override { return "socketcan:" + interface_; }
  std::vector<std::unique_ptr<Channel>> channels() override {
    std::vector<std::unique_ptr<Channel>> all;
    all.push_back(std::make_unique<Channel>(fd_, Speech::kSocketCan));
    handed_out_ = true;
    return all;
  }

 private:
  [[noreturn]] void fail() const {
    throw std::runtime_error("cannot open the CAN interface '" + interface_ + "': " + std::strerror(errno));
  }
  std::string interface_;
  int fd_;
  bool handed_out_ = false;
};

}  // namespace

std::unique_ptr<BusLink> open_socketcan(const std::string& interface) {
  return std::make_unique<SocketCanLink>(interface);
}

}  // namespace visum::bus
