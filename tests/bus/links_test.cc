// Links in need: no descriptor is left for a new client, or a device belongs to another program already.
#include <fcntl.h>
#include <stdlib.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <termios.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "server/bus/bus_thread.h"
#include "server/bus/host_devices.h"
#include "tests/bus/bus_line.h"

namespace visum::bus {
namespace {

using Clock = std::chrono::steady_clock;

// While this exists, no descriptor is free.
class NoDescriptors {
 public:
  NoDescriptors() {
    EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before_), 0);
    const int free = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::close(free);
    const rlimit none{static_cast<rlim_t>(free), before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  }
  ~NoDescriptors() { EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &before_), 0); }

 private:
  rlimit before_{};
};

TEST(TcpLink, TellsThatNoDescriptorIsLeft) {
  const auto link = open_tcp("0");
  const auto line = BusLine::tcp(link->name());
  {
    const NoDescriptors here;
    EXPECT_FALSE(link->accept());
    EXPECT_TRUE(link->is_short());
  }
  EXPECT_TRUE(link->accept());
  EXPECT_FALSE(link->is_short());
  EXPECT_FALSE(link->accept());
  EXPECT_FALSE(link->is_short()) << "nobody came";
}

// A client waits at it for ever.
class ShortLink : public BusLink {
 public:
  explicit ShortLink(std::atomic<int>& asked) : asked_(asked), fd_(::eventfd(1, EFD_CLOEXEC)) {}
  ~ShortLink() override { ::close(fd_); }
  std::string name() const override { return "short"; }
  int listener() const override { return fd_; }
  std::unique_ptr<Channel> accept() override {
    ++asked_;
    return nullptr;
  }
  bool is_short() const override { return true; }

 private:
  std::atomic<int>& asked_;
  int fd_;
};

TEST(BusThread, LeavesAListenerAloneForWhichNoDescriptorIsLeft) {
  std::atomic<int> asked{0};
  std::vector<BusThread::Wiring> wirings;
  wirings.push_back({std::make_unique<ShortLink>(asked), 0});
  const auto begin = Clock::now();
  BusThread bus(std::move(wirings), [] {});
  while (asked == 0) std::this_thread::yield();
  for (int i = 0; i < 1000; ++i) bus.settle({});
  const int times = asked;
  const auto rests = (Clock::now() - begin) / std::chrono::milliseconds(100);
  EXPECT_LE(times, 1 + rests);
  while (asked == times) std::this_thread::yield();  // it is tried again
}

TEST(HostDevice, OfAnotherKeepsItsBitRate) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::grantpt(terminal), 0);
  ASSERT_EQ(::unlockpt(terminal), 0);
  const std::string path = ::ptsname(terminal);
  const auto first = open_serial_device(path + ",9600");
  try {
    open_serial_device(path + ",38400");
    ADD_FAILURE() << "opened";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), path + " is in use by another program");
  }
  termios settings{};
  ASSERT_EQ(::tcgetattr(first->fd(), &settings), 0);
  EXPECT_EQ(::cfgetospeed(&settings), static_cast<speed_t>(B9600));
  ::close(terminal);
}

}  // namespace
}  // namespace visum::bus
