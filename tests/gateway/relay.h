// A TCP port on loopback that forwards to another one. The test may change the other one, or make the relay
// stand still like a stopped server: connected, but silent.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace visum::gateway {

class Relay {
 public:
  explicit Relay(std::uint16_t target) : target_(target), listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    auto address = loopback(0);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listener_, 16), 0);
    EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] {
      while (!ending_) work();
    });
  }
  ~Relay() {
    ending_ = true;
    thread_.join();
    cut();
    ::close(listener_);
  }

  std::uint16_t port() const { return port_; }
  // Cuts all connections.
  void lead_to(std::uint16_t target) {
    const std::lock_guard lock(mutex_);
    target_ = target;
    cut();
    ended_ = 0;
  }
  void stand_still() {
    const std::lock_guard lock(mutex_);
    stands_still_ = true;
  }
  // Connections that one of both sides has closed since lead_to().
  int ended() const { return ended_; }

 private:
  using Pair = std::array<int, 2>;

  static sockaddr_in loopback(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    return address;
  }
  static bool readable(int fd, int patience_ms) {
    pollfd set{fd, POLLIN, 0};
    return ::poll(&set, 1, patience_ms) > 0;
  }

  void work() {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    const std::lock_guard lock(mutex_);
    if (stands_still_) return;
    if (readable(listener_, 0)) admit();
    std::erase_if(pairs_, [this](const Pair& pair) {
      if (carry(pair[0], pair[1]) && carry(pair[1], pair[0])) return false;
      for (const int fd : pair) ::close(fd);
      ++ended_;
      return true;
    });
  }
  void admit() {
    const Pair pair{::accept(listener_, nullptr, nullptr), ::socket(AF_INET, SOCK_STREAM, 0)};
    const auto address = loopback(target_);
    EXPECT_EQ(::connect(pair[1], reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    pairs_.push_back(pair);
  }
  // False: the end.
  static bool carry(int from, int to) {
    char bytes[4096];
    while (readable(from, 0)) {
      const auto count = ::read(from, bytes, sizeof bytes);
      if (count <= 0 || ::send(to, bytes, static_cast<std::size_t>(count), MSG_NOSIGNAL) != count)
        return false;
    }
    return true;
  }
  void cut() {
    for (const auto& pair : std::exchange(pairs_, {}))
      for (const int fd : pair) ::close(fd);
  }

  std::mutex mutex_;
  std::uint16_t target_, port_ = 0;
  int listener_;
  bool stands_still_ = false;
  std::vector<Pair> pairs_;
  std::atomic<int> ended_{0};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace visum::gateway
